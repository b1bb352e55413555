// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/region.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "pointsweep/operators/normals.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "tests/support/memory_source.h"

namespace pointsweep {
namespace {

double uniform_number(std::mt19937_64& rng) { return std::uniform_real_distribution<double>(0, 1)(rng); }

std::vector<Vec3> random_points(std::size_t count) {
  std::mt19937_64 rng(5);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    const double spread = i % 50 == 0 ? 8 : 1;
    points.push_back({spread * uniform_number(rng), spread * uniform_number(rng), uniform_number(rng)});
  }
  return points;
}

StreamOptions small_slabs() {
  StreamOptions options;
  options.slab_points = 200;
  options.canonical = false;
  return options;
}

/// A cloud in slabs whose cells have all been read and dropped.
struct SweptCloud {
  std::vector<Vec3> points = random_points(4000);
  PointSource source = source_of(points);
  PlannedPass planned =
      plan_chain({.neighborhood = {}, .stages = {std::make_shared<Normals>()}}, source.schema).passes.front();
  Stream stream{source, survey(source, std::nullopt, true), small_slabs()};
  SlabLoader loader{stream, planned.plan, 64};
  Frontier frontier{stream.slabs(), stream.axis()};

  SweptCloud() {
    for (std::uint32_t slab = 0; slab < stream.slabs().size(); ++slab) {
      frontier.slab_was_read();
      for (const auto& cell : loader.load(slab, false).cells)
        frontier.cell_was_dropped(slab, {cell->cell.box, cell->number, cell->cell.size()});
    }
  }
};

std::multiset<std::uint64_t> rows_of(const Region& region) {
  std::multiset<std::uint64_t> rows;
  for (std::uint32_t slot = 0; slot < region.size(); ++slot) {
    const Cell& cell = region.at(slot).cell;
    rows.insert(cell.row, cell.row + cell.size());
  }
  return rows;
}

constexpr std::uint64_t kAnyNumber = ~std::uint64_t{0};

TEST(Region, HoldsEveryPointOfTheBallsOnceAndKnowsWhatItLacks) {
  const SweptCloud cloud;
  Region region(cloud.stream, cloud.loader, cloud.frontier, 2);
  std::mt19937_64 rng(6);
  std::vector<NeededBalls> all;
  for (int round = 0; round < 12; ++round) {
    std::vector<NeededBalls> needed(1 + round % 3);
    for (NeededBalls& balls : needed) {
      for (int i = 0; i < 4; ++i) {
        const Vec3 center = cloud.points[rng() % cloud.points.size()];
        const double reach = 0.2 * uniform_number(rng);
        balls.add(center, reach * reach);
      }
      all.push_back(balls);
    }
    const std::uint64_t read = region.slabs_read();
    ASSERT_TRUE(region.load(needed, {}, kAnyNumber));
    ASSERT_LE(region.slabs_read() - read, cloud.stream.slabs().size()) << "a slab is read once";
    const std::multiset<std::uint64_t> rows = rows_of(region);
    ASSERT_EQ(rows.size(), region.points());
    ASSERT_EQ(std::set(rows.begin(), rows.end()).size(), rows.size()) << "no point twice";
    std::vector<Box> missing;
    for (const NeededBalls& balls : all) {
      for (const auto& [center, reach2] : balls.balls) {
        region.missing_near({center, center}, reach2, missing);
        ASSERT_TRUE(missing.empty());
        for (std::uint64_t row = 0; row < cloud.points.size(); ++row)
          ASSERT_TRUE(distance2(cloud.points[row], center) > reach2 || rows.contains(row)) << row;
      }
    }
    for (int i = 0; i < 50; ++i) {
      const Vec3 center = cloud.points[rng() % cloud.points.size()];
      const double reach2 = uniform_number(rng);
      region.missing_near({center, center}, reach2, missing);
      for (std::uint64_t row = 0; row < cloud.points.size(); ++row) {
        if (distance2(cloud.points[row], center) > reach2 || rows.contains(row)) continue;
        ASSERT_TRUE(std::ranges::any_of(missing, [&](const Box& box) {
          return distance2(box, cloud.points[row]) == 0;
        })) << "a point that is not in memory must lie in a box that is said to be missing";
      }
    }
  }
  EXPECT_LT(region.points(), cloud.points.size()) << "the test would not see a region that loads everything";
}

TEST(Region, LoadsTheCellOfAPlace) {
  const SweptCloud cloud;
  for (const std::uint32_t slab : {0u, 3u}) {
    Region region(cloud.stream, cloud.loader, cloud.frontier, 1);
    const std::vector<NeededPlace> places = {{slab, 0}, {slab, 7}};
    ASSERT_TRUE(region.load({}, places, kAnyNumber));
    EXPECT_EQ(region.slabs_read(), 1u);
    std::set<std::uint32_t> found;
    for (std::uint32_t slot = 0; slot < region.size(); ++slot) {
      EXPECT_EQ(region.at(slot).slab, slab);
      found.insert(region.at(slot).index_in_slab.begin(), region.at(slot).index_in_slab.end());
    }
    EXPECT_TRUE(found.contains(0) && found.contains(7));
    EXPECT_LE(region.size(), 2u);
  }
}

TEST(Region, StopsLoadingWhenItHoldsTooManyPoints) {
  const SweptCloud cloud;
  Region region(cloud.stream, cloud.loader, cloud.frontier, 1);
  NeededBalls everything;
  everything.add(cloud.points[0], 1e6);
  EXPECT_FALSE(region.load({&everything, 1}, {}, 500));
  EXPECT_GT(region.points(), 500u);
  EXPECT_LT(region.points(), cloud.points.size());
}

TEST(Region, TheNearestCellsHoldAsManyPointsAsAskedAndNoMoreThanOneCellTooMany) {
  const SweptCloud cloud;
  const Region region(cloud.stream, cloud.loader, cloud.frontier, 1);
  for (std::size_t i = 0; i < cloud.points.size(); i += 97) {
    for (const std::uint64_t count : {std::uint64_t{1}, std::uint64_t{9}, std::uint64_t{300}, cloud.points.size()}) {
      const double reach2 = region.reach2_of_cells(cloud.points[i], count);
      std::uint64_t within = 0, nearer = 0;
      for (std::uint32_t slab = 0; slab < cloud.stream.slabs().size(); ++slab) {
        for (const DroppedCell& cell : cloud.frontier.dropped_of(slab)) {
          if (distance2(cell.box, cloud.points[i]) <= reach2) within += cell.points;
          if (distance2(cell.box, cloud.points[i]) < reach2) nearer += cell.points;
        }
      }
      ASSERT_GE(within, count);
      ASSERT_LT(nearer, count);
    }
    ASSERT_EQ(region.reach2_of_cells(cloud.points[i], cloud.points.size() + 1), Box::kInf);
  }
}

}  // namespace
}  // namespace pointsweep
