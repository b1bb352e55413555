// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>

#include "pointsweep/verify/rows/row_alignment.h"

namespace pointsweep {
namespace {

TEST(SampleRows, AreDifferentAscendAndExist) {
  for (const std::uint64_t count : {1u, 10u, 1000u})
    for (const std::uint64_t size : {0u, 1u, 9u, 10u, 500u}) {
      const auto rows = sample_rows(count, size, 3);
      ASSERT_EQ(rows.size(), std::min(count, size));
      EXPECT_TRUE(std::is_sorted(rows.begin(), rows.end()));
      EXPECT_EQ(std::adjacent_find(rows.begin(), rows.end()), rows.end());
      EXPECT_TRUE(rows.empty() || rows.back() < count);
    }
}

TEST(SampleRows, ReachPastFourBillionRows) {
  const std::uint64_t count = std::uint64_t{1} << 40;
  const auto rows = sample_rows(count, 1000, 3);
  EXPECT_GT(rows.back(), count / 2);
  EXPECT_LT(rows.front(), count / 2);
}

TEST(SampleRows, DependOnTheSeedAlone) {
  EXPECT_EQ(sample_rows(1000, 50, 7), sample_rows(1000, 50, 7));
  EXPECT_NE(sample_rows(1000, 50, 7), sample_rows(1000, 50, 8));
}

TEST(SampleRows, EveryRowIsAsLikelyAsAnother) {
  std::vector<int> times(20);
  for (std::uint64_t seed = 0; seed < 10000; ++seed)
    for (const std::uint64_t row : sample_rows(20, 5, seed)) ++times[row];
  for (const int t : times) EXPECT_NEAR(t, 2500, 250);  // five standard deviations and more
}

}  // namespace
}  // namespace pointsweep
