// SPDX-License-Identifier: MIT
/// The results of the recall are those of a sweep that recalls nothing, for any memory.
#include "pointsweep/sweep/recall.h"

#include <gtest/gtest.h>

#include "tests/sweep/swept_cloud.h"

namespace pointsweep {
namespace {

TEST(Recall, GivesTheBytesOfASweepThatRecallsNothing) {
  for (const auto& [name, points] : clouds()) {
    std::uint64_t recalled = 0;
    for (const std::size_t k : {std::size_t{6}, std::size_t{20}, std::size_t{70}}) {
      const Swept whole = swept(points, deep_chain(k), points.size() + 1, {});
      ASSERT_EQ(whole.statistics.recalled, 0u) << name;
      for (const std::size_t recall_bytes : {std::size_t{1}, std::size_t{300'000}, std::size_t{64} << 20}) {
        if (recall_bytes == 1 && k > 6) continue;  // slow: every point is a group, searched again for each step
        if (recall_bytes == 300'000 && k == 70) continue;
        SCOPED_TRACE(name + ", k " + std::to_string(k) + ", " + std::to_string(recall_bytes) + " bytes");
        SweepOptions options;
        options.cell_points = 32, options.recall_bytes = recall_bytes, options.lists_bytes = 4096;
        const Swept some = swept(points, deep_chain(k), 40, options);
        expect_same(some, whole);
        recalled += some.statistics.recalled;
      }
    }
    EXPECT_GT(recalled, 25u) << name << ": the recall was not put to the test";
  }
}

/// A point is counted once, whether the sweep or the recall searched it.
TEST(Recall, CountsTheDistancesOfEveryPointOnce) {
  const std::vector<Vec3> points = clouds().front().second;
  const auto count = [](const DistanceHistogram& histogram) {
    std::uint64_t all = 0;
    for (std::size_t bin = 0; bin < DistanceHistogram::kBins; ++bin) all += histogram.count(bin);
    return all;
  };
  SweepOptions options;
  options.cell_points = 64, options.count_distances = true;
  const Swept some = swept(points, deep_chain(8), 40, options);
  EXPECT_GT(some.statistics.recalled, 2u);
  EXPECT_EQ(count(some.statistics.distances.farthest), points.size());
}

}  // namespace
}  // namespace pointsweep
