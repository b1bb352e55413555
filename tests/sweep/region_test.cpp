// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "pointsweep/operators/surface/normals.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/sweep/recalled_points.h"
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
  for (std::uint32_t slot = 0; slot < region.slot_count(); ++slot) {
    const Cell& cell = region.at(slot).cell;
    rows.insert(cell.row, cell.row + cell.size());
  }
  return rows;
}

constexpr std::uint64_t kAnyNumber = ~std::uint64_t{0};

std::vector<Ball> random_balls(const SweptCloud& cloud, std::mt19937_64& rng, std::size_t count) {
  std::vector<Ball> balls;
  while (balls.size() < count) {
    const double reach = 0.3 * uniform_number(rng);
    balls.push_back({cloud.points[rng() % cloud.points.size()], reach * reach});
  }
  return balls;
}

/// Points farther from all balls than the width of a ball are not read into the region.
TEST(Region, HoldsThePointsOfTheBallsOnceAndFewOthers) {
  const SweptCloud cloud;
  Region region(cloud.stream, cloud.loader, cloud.frontier, 2);
  std::mt19937_64 rng(6);
  std::vector<Ball> all;
  for (int round = 0; round < 8; ++round) {
    const std::vector<Ball> balls = random_balls(cloud, rng, 5);
    all.insert(all.end(), balls.begin(), balls.end());
    const std::uint64_t read = region.slabs_read().slabs;
    ASSERT_TRUE(region.collect({.whole_balls = balls, .most_points = kAnyNumber}));
    ASSERT_LE(region.slabs_read().slabs - read, cloud.stream.slabs().size()) << "a slab is read once";
    const std::multiset<std::uint64_t> rows = rows_of(region);
    ASSERT_EQ(region.points(), rows.size());
    for (std::uint64_t row = 0; row < cloud.points.size(); ++row) {
      ASSERT_LE(rows.count(row), 1u);
      const auto within = [&](double widths) {
        return std::ranges::any_of(all, [&](const Ball& ball) {
          return std::sqrt(distance2(ball.center, cloud.points[row])) <= widths * std::sqrt(ball.reach2);
        });
      };
      ASSERT_TRUE(rows.contains(row) || !within(1));
      ASSERT_TRUE(!rows.contains(row) || within(1 + 2 * std::sqrt(3)));
    }
  }
  EXPECT_LT(region.points(), cloud.points.size()) << "the test would not see a region that loads everything";
}

/// Balls shrink while threads fill them in any order. The nearest points of each ball, with ties, are left.
TEST(Region, HoldsAsManyNearestPointsOfEachBallAsAreWanted) {
  const SweptCloud cloud;
  std::mt19937_64 rng(7);
  for (const std::uint64_t nearest : {std::uint64_t{1}, std::uint64_t{9}, std::uint64_t{100}}) {
    std::vector<Ball> balls = random_balls(cloud, rng, 30);
    balls.push_back({{-3, 2, 8}, Box::kInf});
    std::multiset<std::uint64_t> expected;
    for (const Ball& ball : balls) {
      std::vector<double> inside;
      for (const Vec3& p : cloud.points)
        if (const double d2 = distance2(ball.center, p); d2 <= ball.reach2) inside.push_back(d2);
      std::ranges::sort(inside);
      if (inside.empty()) continue;
      const double last = inside[std::min<std::size_t>(nearest, inside.size()) - 1];
      for (std::uint64_t row = 0; row < cloud.points.size(); ++row)
        if (distance2(ball.center, cloud.points[row]) <= last && !expected.contains(row)) expected.insert(row);
    }
    Region region(cloud.stream, cloud.loader, cloud.frontier, 2);
    ASSERT_TRUE(region.collect({.balls = balls, .nearest = nearest, .most_points = kAnyNumber}));
    ASSERT_EQ(rows_of(region), expected) << nearest;
  }
}

TEST(Region, HoldsThePlacesThatAreNeeded) {
  const SweptCloud cloud;
  for (const std::uint32_t slab : {0u, 3u}) {
    Region region(cloud.stream, cloud.loader, cloud.frontier, 1);
    ASSERT_TRUE(region.collect({.places = {{slab, 0}, {slab, 7}}, .most_points = kAnyNumber}));
    EXPECT_EQ(region.slabs_read().slabs, 1u);
    std::set<std::uint32_t> found;
    for (std::uint32_t slot = 0; slot < region.slot_count(); ++slot) {
      EXPECT_EQ(region.at(slot).slab, slab);
      found.insert(region.at(slot).index_in_slab.begin(), region.at(slot).index_in_slab.end());
    }
    EXPECT_EQ(found, (std::set<std::uint32_t>{0, 7}));
  }
}

TEST(Region, StopsWhenItWouldHoldTooManyPoints) {
  const SweptCloud cloud;
  Region region(cloud.stream, cloud.loader, cloud.frontier, 1);
  EXPECT_FALSE(region.collect({.whole_balls = {{cloud.points[0], 1e12}}, .most_points = 500}));
  EXPECT_LT(region.slabs_read().slabs, cloud.stream.slabs().size());
  Region of_the_nearest(cloud.stream, cloud.loader, cloud.frontier, 1);
  EXPECT_TRUE(of_the_nearest.collect({.balls = {{cloud.points[0], 1e12}}, .nearest = 400, .most_points = 500}))
      << "more come in before the ball shrinks";
}

TEST(Region, AsManyPointsAsAskedLieWithinTheDistanceThatHoldsThem) {
  const SweptCloud cloud;
  const Region region(cloud.stream, cloud.loader, cloud.frontier, 1);
  for (std::size_t i = 0; i < cloud.points.size(); i += 97) {
    const Vec3 p = cloud.points[i];
    for (const std::uint64_t count : {std::uint64_t{1}, std::uint64_t{9}, std::uint64_t{300}, std::uint64_t{4000}}) {
      const double reach2 = region.reach2_that_holds(p, count);
      const auto within = std::ranges::count_if(cloud.points, [&](const Vec3& q) { return distance2(p, q) <= reach2; });
      ASSERT_GE(static_cast<std::uint64_t>(within), count);
      ASSERT_EQ(region.touches_more_than(count - 1, p, reach2), true);
    }
    ASSERT_EQ(region.reach2_that_holds(p, cloud.points.size() + 1), Box::kInf);
    ASSERT_FALSE(region.touches_more_than(cloud.points.size(), p, Box::kInf));
  }
}

}  // namespace
}  // namespace pointsweep
