// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <stdexcept>

#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

TEST(Prefetch, HandsOutInOrderAndNeverMoreThanItsDepthAhead) {
  for (const unsigned threads : {1u, 4u}) {
    with_threads(threads, [&] {
      std::atomic<std::size_t> begun = 0, used = 0;
      std::atomic<bool> too_far = false;
      const auto make = [&](std::size_t i) {
        if (++begun - used > 4) too_far = true;  // three pending, and one that has just been handed out
        return std::make_unique<std::size_t>(i * i);
      };
      Prefetch<std::unique_ptr<std::size_t>> squares(make, 5, 105, 3);
      for (std::size_t i = 5; i < 105; ++i, ++used) EXPECT_EQ(*squares.next(), i * i);
      EXPECT_EQ(begun, 100u);
      EXPECT_FALSE(too_far);
    });
  }
}

TEST(Prefetch, ThrowsWhatAMakingThrewInItsTurn) {
  with_threads(2, [] {
    Prefetch<int> numbers(
        [](std::size_t i) -> int {
          if (i == 2) throw std::runtime_error("two");
          return static_cast<int>(i);
        },
        0, 10, 4);
    EXPECT_EQ(numbers.next(), 0);
    EXPECT_EQ(numbers.next(), 1);
    EXPECT_THROW(numbers.next(), std::runtime_error);
  });
}

TEST(Prefetch, MayBeLeftBeforeItsEnd) {
  with_threads(2, [] {
    const auto made = std::make_shared<std::atomic<int>>(0);
    {
      Prefetch<int> numbers([made](std::size_t i) { return ++*made, static_cast<int>(i); }, 0, 1000, 2);
      EXPECT_EQ(numbers.next(), 0);
    }
    EXPECT_LE(*made, 3);
    EXPECT_EQ(made.use_count(), 1);
  });
}

}  // namespace
}  // namespace pointsweep
