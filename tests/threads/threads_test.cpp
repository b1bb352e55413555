// SPDX-License-Identifier: MIT
#include "pointsweep/threads.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace pointsweep {
namespace {

TEST(ParallelFor, DoesEveryPieceOnceAndNeverTwoOfOneWorkerAtATime) {
  for (const unsigned threads : {1u, 2u, 7u}) {
    with_threads(threads, [&] {
      ASSERT_EQ(thread_count(), threads);
      std::vector<std::atomic<int>> done(1000);
      std::array<std::atomic<int>, 7> busy{};
      std::atomic<bool> clash = false;
      parallel_for(done.size(), [&](std::size_t i, unsigned worker) {
        if (worker >= threads || ++busy[worker] != 1) clash = true;
        ++done[i];
        --busy[worker];
      });
      EXPECT_FALSE(clash);
      for (const auto& times : done) EXPECT_EQ(times, 1);
    });
  }
}

TEST(ParallelFor, InsideAPieceDoesNotTakeUpAnotherOne) {
  with_threads(4, [] {
    static thread_local bool inside;
    std::atomic<bool> clash = false;
    std::atomic<int> done = 0;
    parallel_for(64, [&](std::size_t, unsigned) {
      if (inside) clash = true;  // a lock held by the piece would be waited for forever
      inside = true;
      parallel_for(4, [&](std::size_t, unsigned) {
        std::this_thread::sleep_for(std::chrono::microseconds(200));  // long enough for other threads to help
        ++done;
      });
      inside = false;
    });
    EXPECT_FALSE(clash);
    EXPECT_EQ(done, 64 * 4);
  });
}

/// Returns whether two pieces of a loop run at the same time.
bool two_pieces_meet() {
  std::atomic<int> here = 0;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  parallel_for(2, [&](std::size_t, unsigned) {
    ++here;
    while (here < 2 && std::chrono::steady_clock::now() < end) std::this_thread::yield();
  });
  return std::chrono::steady_clock::now() < end;
}

TEST(WithThreads, InsideAnotherMayHaveMoreThreads) {
  with_threads(1, [] {
    with_threads(3, [] {
      EXPECT_EQ(thread_count(), 3u);
      EXPECT_TRUE(two_pieces_meet());
      with_threads(1, [] { EXPECT_EQ(thread_count(), 1u); });
      EXPECT_THROW(with_threads(2, [] { throw std::runtime_error("no"); }), std::runtime_error);
      EXPECT_EQ(thread_count(), 3u);
      EXPECT_TRUE(two_pieces_meet());
    });
    EXPECT_EQ(thread_count(), 1u);
  });
}

TEST(ParallelFor, DoesNothingForNoPieces) {
  parallel_for(0, [](std::size_t, unsigned) { FAIL(); });
}

TEST(ParallelFor, EndsWithWhatAPieceThrew) {
  with_threads(3, [] {
    const auto body = [](std::size_t i, unsigned) {
      if (i == 77) throw std::runtime_error("piece 77");
    };
    EXPECT_THROW(parallel_for(1000, body), std::runtime_error);
  });
}

TEST(ParallelFor, ThrowsWhatTheLowestPieceThrewForAnyNumberOfThreads) {
  for (const unsigned threads : {1u, 2u, 7u})
    with_threads(threads, [] {
      const auto body = [](std::size_t i, unsigned) {
        if (i == 41) std::this_thread::sleep_for(std::chrono::milliseconds(2));  // other pieces fail before this one
        if (i % 10 == 1 && i > 40) throw std::runtime_error(std::to_string(i));
      };
      try {
        parallel_for(1000, body);
        FAIL();
      } catch (const std::runtime_error& error) {
        EXPECT_STREQ(error.what(), "41");
      }
    });
}

TEST(BackgroundTask, HasDoneItsWorkWhenWaitReturns) {
  with_threads(2, [] {
    int done = 0;
    BackgroundTask task([&] { done = 1; });
    task.wait();
    EXPECT_EQ(done, 1);
  });
}

TEST(BackgroundTask, ThrowsItsFailureFromWaitAndDropsItOtherwise) {
  with_threads(2, [] {
    BackgroundTask waited([] { throw std::runtime_error("no"); });
    EXPECT_THROW(waited.wait(), std::runtime_error);
    const BackgroundTask dropped([] { throw std::runtime_error("no"); });
  });
}

}  // namespace
}  // namespace pointsweep
