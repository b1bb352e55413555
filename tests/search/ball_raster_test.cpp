// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "pointsweep/search/ball_lookup.h"

namespace pointsweep {
namespace {

/// Returns how many of the points of the box may lie in a ball. Expects that no point in a ball is excluded.
std::size_t may_lie_in_a_ball(const Box& box, const std::vector<Ball>& balls, const std::vector<Vec3>& points) {
  const BallRaster raster(box, balls);
  std::size_t may = 0;
  for (const Vec3& p : points) {
    const bool lies = std::ranges::any_of(balls, [&](const Ball& b) { return distance2(b.center, p) <= b.reach2; });
    may += raster.may_hold(p);
    EXPECT_TRUE(raster.may_hold(p) || !lies);
  }
  return may;
}

void expect_few_points_near_small_balls(Vec3 lo, Vec3 extent, std::uint64_t seed) {
  const Box box{lo, lo + extent};
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> share(0, 1);
  const auto place = [&] {
    const Vec3 p = lo + Vec3{share(random) * extent.x, share(random) * extent.y, share(random) * extent.z};
    return Vec3{std::min(p.x, box.hi.x), std::min(p.y, box.hi.y), std::min(p.z, box.hi.z)};
  };
  const double widest = std::max({extent.x, extent.y, extent.z});
  std::vector<Vec3> points = {box.lo, box.hi};
  std::vector<Ball> balls;
  for (int i = 0; i < 4000; ++i) points.push_back(place());
  for (int i = 0; i < 6; ++i) {
    const double radius = widest / 50 * share(random);
    balls.push_back({place(), radius * radius});
    for (const double sign : {-1.0, 1.0})  // on the ball, exactly or nearly
      if (const double x = balls.back().center.x + sign * radius; x >= box.lo.x && x <= box.hi.x)
        points.push_back({x, balls.back().center.y, balls.back().center.z});
  }
  const std::size_t may = may_lie_in_a_ball(box, balls, points);
  EXPECT_LT(may, points.size() / 4) << "a raster that marks everything spares nothing";
}

TEST(BallRaster, TellsPointsThatLieInNoBall) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    expect_few_points_near_small_balls({0, 0, 0}, {1, 1, 1}, seed);
    expect_few_points_near_small_balls({-3, 7, 1}, {1e-3, 40, 25}, seed);  // a slab
    expect_few_points_near_small_balls({5e6, -5e5, 100}, {0.25, 0, 1000}, seed);
    expect_few_points_near_small_balls({1e12, 1e12, -1e12}, {2000, 1000, 1500}, seed);
  }
}

TEST(BallRaster, TakesABoxOfOnePointAndAnUnboundedBall) {
  const Vec3 p{1, 2, 3};
  EXPECT_EQ(may_lie_in_a_ball({p, p}, {{p, 0}}, {p}), 1u);
  const std::vector<Vec3> corners = {{0, 0, 0}, {1, 2, 3}, {0.5, 2, 0}};
  EXPECT_EQ(may_lie_in_a_ball({{0, 0, 0}, p}, {{{50, 50, 50}, Box::kInf}}, corners), 3u);
  EXPECT_EQ(may_lie_in_a_ball({{0, 0, 0}, p}, {}, corners), 0u);
}

}  // namespace
}  // namespace pointsweep
