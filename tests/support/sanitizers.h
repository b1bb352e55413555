// SPDX-License-Identifier: MIT
/// Which sanitizer watches this program. It is asked while tests run: the same objects of the tests are linked with the
/// library of a release and with that of the address sanitizer (tests/CMakeLists.txt).
#pragma once

extern "C" {
void __asan_init() __attribute__((weak));
void __tsan_init() __attribute__((weak));
}

namespace pointsweep {

inline bool has_address_sanitizer() { return __asan_init != nullptr; }
inline bool has_thread_sanitizer() { return __tsan_init != nullptr; }
/// They take memory of their own, by far more than the library.
inline bool has_sanitizer() { return has_address_sanitizer() || has_thread_sanitizer(); }

}  // namespace pointsweep
