// SPDX-License-Identifier: MIT
/// Wall and CPU seconds of a part of a process, all its threads together.
#pragma once

#include <sys/resource.h>

#include <chrono>

namespace bench {

struct Seconds {
  double wall, cpu;
};

inline Seconds now() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
  return {std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(),
          seconds(usage.ru_utime) + seconds(usage.ru_stime)};
}

template <class Work>
Seconds measured(Work work) {
  const Seconds begin = now();
  work();
  const Seconds end = now();
  return {end.wall - begin.wall, end.cpu - begin.cpu};
}

}  // namespace bench
