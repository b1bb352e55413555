// SPDX-License-Identifier: MIT
#include "pointsweep/storage/remote/waiting_threads.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

#include "pointsweep/cancellation.h"
#include "pointsweep/first_failure.h"

namespace pointsweep {

void for_each_waiting(std::size_t count, const std::function<void(std::size_t i)>& body) {
  constexpr std::size_t kMostThreads = 16;
  std::atomic<std::size_t> next = 0;
  FirstFailure failure;
  const auto work = [&, token = CancellationScope::current()] {
    const CancellationScope scope(token);
    for (std::size_t i = next++; i < count && !failure.makes_needless(i); i = next++)
      failure.note_from(i, [&] {
        stop_if_cancelled();
        body(i);
      });
  };
  std::vector<std::thread> others;
  for (std::size_t t = 1; t < std::min(count, kMostThreads); ++t) others.emplace_back(work);
  work();
  for (std::thread& other : others) other.join();
  failure.rethrow();
}

}  // namespace pointsweep
