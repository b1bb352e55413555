// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/sweep.h"

#include <gtest/gtest.h>

#include "tests/sweep/swept_cloud.h"

namespace pointsweep {
namespace {

TEST(Sweep, GivesTheSameBytesHoweverManySlabsATurnReads) {
  for (const auto& [name, points] : clouds()) {
    const Swept whole = swept(points, deep_chain(6), points.size() + 1, {});
    for (const std::uint32_t slabs : {1u, 2u, 5u, 1000u}) {
      SCOPED_TRACE(name + ", turns of " + std::to_string(slabs) + " slabs");
      SweepOptions options;
      options.cell_points = 32, options.slabs_per_turn = slabs, options.read_ahead = 2;
      expect_same(swept(points, deep_chain(6), 40, options), whole);
    }
  }
}

TEST(Sweep, TakesTheStepsOnceForEachTurn) {
  const std::vector<Vec3> points = clouds().front().second;
  const auto turns = [&](std::uint32_t slabs) {
    SweepOptions options;
    options.cell_points = 32, options.slabs_per_turn = slabs;
    return swept(points, deep_chain(6), 40, options).statistics;
  };
  const SweepStatistics one = turns(1), four = turns(4);
  EXPECT_EQ(four.series.size(), (one.series.size() + 3) / 4);
  EXPECT_EQ(four.series.back().first, points.size());
  EXPECT_GT(four.peak_points, one.peak_points);
  EXPECT_EQ(turns(1000).series.size(), 1u);
  EXPECT_EQ(turns(1000).peak_points, points.size());
}

}  // namespace
}  // namespace pointsweep
