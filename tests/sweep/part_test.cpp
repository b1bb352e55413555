// SPDX-License-Identifier: MIT
/// A part of a cloud has the bytes of the whole cloud wherever it can prove them.
#include <gtest/gtest.h>

#include <set>

#include "tests/support/brute_force.h"
#include "tests/sweep/swept_cloud.h"

namespace pointsweep {
namespace {

/// The points of a cloud in a slice along x, and boxes of all others.
struct Part {
  std::vector<Vec3> points;
  std::vector<std::uint64_t> rows;  ///< in the whole cloud
  std::vector<Box> outside;
};

Part slice(const std::vector<Vec3>& cloud, double from, double to) {
  Part part;
  Box before, behind;
  for (std::size_t row = 0; row < cloud.size(); ++row) {
    const Vec3 p = cloud[row];
    if (p.x >= from && p.x <= to)
      part.points.push_back(p), part.rows.push_back(row);
    else
      (p.x < from ? before : behind).include(p);
  }
  for (const Box& box : {before, behind})
    if (!box.empty()) part.outside.push_back(box);
  return part;
}

class PartOfACloud : public testing::TestWithParam<std::uint64_t> {};  // points of a slab

TEST_P(PartOfACloud, HasTheBytesOfTheWholeCloudOrListsThePoint) {
  for (const auto& [name, cloud] : clouds()) {
    for (const std::size_t k : {std::size_t{6}, std::size_t{70}}) {
      SCOPED_TRACE(name + ", k " + std::to_string(k));
      const Swept whole = swept(cloud, deep_chain(k), cloud.size() + 1, {});
      const Part part = slice(cloud, 0.9, 3.1);
      SweepOptions options;
      options.cell_points = 32, options.outside = part.outside;
      const Swept some = swept(part.points, deep_chain(k), GetParam(), options);
      std::set<std::uint64_t> unresolved;
      for (const UnresolvedPoint& point : some.statistics.unresolved) unresolved.insert(point.row);
      EXPECT_EQ(some.statistics.certified, part.points.size() - unresolved.size());
      ASSERT_FALSE(unresolved.empty());
      const std::size_t bytes = whole.records.size() / cloud.size();
      for (std::size_t row = 0; row < part.points.size(); ++row) {
        if (unresolved.contains(row)) continue;
        ASSERT_EQ(std::memcmp(&some.records[row * bytes], &whole.records[part.rows[row] * bytes], bytes), 0) << row;
      }
    }
  }
}

/// Nothing is unresolved in vain: the ball of a point that is unresolved in the first step touches a box, and one step
/// later that of a point or of a neighbour does.
TEST_P(PartOfACloud, ListsOnlyPointsThatDependOnOthers) {
  const std::vector<Vec3> cloud = clouds().front().second;
  const Part part = slice(cloud, 0.9, 3.1);
  const std::size_t k = 6;
  SweepOptions options;
  options.cell_points = 32, options.outside = part.outside;
  const Swept some = swept(part.points, deep_chain(k), GetParam(), options);
  const std::vector<std::vector<std::uint32_t>> neighbors = brute_force_neighbors(part.points, k);
  std::vector<std::uint32_t> from(part.points.size());  // the first step that a point cannot take
  for (std::size_t row = 0; row < from.size(); ++row) {
    const double reach2 = distance2(part.points[row], part.points[neighbors[row].back()]);
    const auto touches = [&](const Box& box) { return distance2(box, part.points[row]) <= reach2; };
    from[row] = std::ranges::any_of(part.outside, touches) ? 0 : 4;
  }
  for (std::uint32_t step = 1; step < 4; ++step) {
    std::vector<std::uint32_t> next = from;
    for (std::size_t row = 0; row < from.size(); ++row)
      for (const std::uint32_t other : neighbors[row])
        if (from[other] < step && from[row] > step) next[row] = step;
    from = next;
  }
  std::vector<std::uint32_t> found(part.points.size(), 4);
  for (const UnresolvedPoint& point : some.statistics.unresolved) found[point.row] = point.step;
  EXPECT_EQ(found, from);
}

TEST(Part, OfFewerPointsThanAreWantedLeavesAllUnresolved) {
  const std::vector<Vec3> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  SweepOptions options;
  options.outside = {{{100, 0, 0}, {101, 1, 1}}};
  const Swept swept_part = swept(points, deep_chain(6), 100, options);
  ASSERT_EQ(swept_part.statistics.unresolved.size(), points.size());
  for (const UnresolvedPoint& point : swept_part.statistics.unresolved) EXPECT_EQ(point.reach2, Box::kInf);
}

INSTANTIATE_TEST_SUITE_P(Slabs, PartOfACloud, testing::Values(40, 10'000));

}  // namespace
}  // namespace pointsweep
