// SPDX-License-Identifier: MIT
/// Tells the thread sanitizer of an order it cannot see: Debian's oneTBB is not built with it.
#pragma once

#if defined(__SANITIZE_THREAD__)
extern "C" {
void __tsan_acquire(void* address);
void __tsan_release(void* address);
}
#endif

namespace pointsweep {

/// What one thread did before give() comes before what another does after take(). Used where the task library
/// guarantees that; it synchronises nothing and is nothing in ordinary builds. Two of them bracket a parallel loop, so
/// that the tasks of one loop are not taken to be ordered among themselves.
class HandOver {
 public:
#if defined(__SANITIZE_THREAD__)
  void give() { __tsan_release(this); }
  void take() { __tsan_acquire(this); }
#else
  void give() {}
  void take() {}
#endif
};

}  // namespace pointsweep
