// SPDX-License-Identifier: MIT
/// Tells at run time which sanitizer watches this program: equal object files of the tests are linked with the library
/// of a release and with that of the address sanitizer (tests/CMakeLists.txt).
#pragma once

extern "C" {
void __asan_init() __attribute__((weak));
void __tsan_init() __attribute__((weak));
}

namespace pointsweep {

inline bool has_address_sanitizer() { return __asan_init != nullptr; }
inline bool has_thread_sanitizer() { return __tsan_init != nullptr; }
/// Returns whether a sanitizer watches this program. Sanitizers take far more memory than the library.
inline bool has_sanitizer() { return has_address_sanitizer() || has_thread_sanitizer(); }

}  // namespace pointsweep
