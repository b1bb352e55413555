// SPDX-License-Identifier: MIT
#include "pointsweep/cancellation.h"

#include <gtest/gtest.h>

#include <atomic>

#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

TEST(Cancellation, EndsOnlyWhatIsInItsScope) {
  CancellationToken token;
  token.cancel();
  EXPECT_NO_THROW(stop_if_cancelled());
  {
    const CancellationScope scope(&token);
    EXPECT_THROW(stop_if_cancelled(), Cancelled);
    const CancellationScope inner(nullptr);
    EXPECT_THROW(stop_if_cancelled(), Cancelled) << "no token of its own: that of the scope around it";
    CancellationToken other;
    const CancellationScope replaced(&other);
    EXPECT_NO_THROW(stop_if_cancelled());
  }
  EXPECT_NO_THROW(stop_if_cancelled());
}

TEST(Cancellation, ReachesEveryThreadOfALoopAndOfLoopsInside) {
  CancellationToken token;
  std::atomic<int> outside = 0;
  with_threads(4, [&] {
    const CancellationScope scope(&token);
    parallel_for(64, [&](std::size_t, unsigned) {
      if (CancellationScope::current() != &token) ++outside;
      parallel_for(4, [&](std::size_t, unsigned) {
        if (CancellationScope::current() != &token) ++outside;
      });
    });
    parallel_for(1000, [&](std::size_t, unsigned) {});
  });
  EXPECT_EQ(outside, 0);
}

TEST(Cancellation, EndsALoopThatDoesNotLook) {
  CancellationToken token;
  std::atomic<int> begun = 0;
  with_threads(2, [&] {
    const CancellationScope scope(&token);
    const auto loop = [&] {
      parallel_for(1'000'000, [&](std::size_t, unsigned) {
        if (++begun == 10) token.cancel();
      });
    };
    EXPECT_THROW(loop(), Cancelled);
  });
  EXPECT_LT(begun, 1000);
}

TEST(Cancellation, ReachesWorkInTheBackground) {
  CancellationToken token;
  const CancellationScope scope(&token);
  Prefetch<int> things(
      [&](std::size_t i) {
        if (i == 3) token.cancel();
        stop_if_cancelled();
        return static_cast<int>(i);
      },
      0, 10, 1);
  EXPECT_EQ(things.next(), 0);
  EXPECT_EQ(things.next(), 1);
  EXPECT_THROW((things.next(), things.next()), Cancelled);
}

}  // namespace
}  // namespace pointsweep
