// SPDX-License-Identifier: MIT
#include "pointsweep/search/ball_lookup.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace pointsweep {
namespace {

std::vector<std::uint32_t> named(const BallLookup& index, Vec3 p) {
  std::vector<std::uint32_t> numbers;
  index.for_each_near(p, [&](std::uint32_t number) { numbers.push_back(number); });
  std::ranges::sort(numbers);
  return numbers;
}

/// Expects that the lookup names all balls that hold a point, for points and balls of sizes from 1e-9 to 1e3 around
/// `middle`. Some points lie exactly on a ball.
void expect_names_all_that_hold(Vec3 middle, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Ball> balls;
  std::vector<Vec3> points;
  for (int i = 0; i < 300; ++i) {
    const double size = std::pow(10, 6 * uniform(rng) - 3), away = std::pow(10, 6 * uniform(rng) - 3);
    const Vec3 center = middle + Vec3{away * uniform(rng), away * uniform(rng), away * uniform(rng)};
    const Vec3 on = center + Vec3{size * uniform(rng), size * uniform(rng), i % 3 == 0 ? 0 : size * uniform(rng)};
    balls.push_back({center, i % 50 == 0 ? 0 : distance2(center, on)});
    points.push_back(i % 50 == 0 ? center : on);
  }
  balls.push_back({middle, Box::kInf});
  const BallLookup index(balls);
  std::size_t holds = 0, asked = 0;
  for (const Vec3& p : points) {
    const std::vector<std::uint32_t> numbers = named(index, p);
    ASSERT_EQ(std::ranges::adjacent_find(numbers), numbers.end()) << "a ball is named once";
    asked += numbers.size();
    for (std::uint32_t number = 0; number < balls.size(); ++number) {
      if (distance2(balls[number].center, p) > balls[number].reach2) continue;
      ++holds;
      ASSERT_TRUE(std::ranges::binary_search(numbers, number)) << "ball " << number;
    }
  }
  balls.pop_back();
  const BallCover cover(balls);
  for (const Vec3& p : points) ASSERT_TRUE(cover.covers(p)) << "each point lies on a ball";
  EXPECT_GE(holds, 2 * points.size()) << "the unbounded ball holds all points, and each point lies on one ball";
  EXPECT_LT(asked, points.size() * balls.size()) << "the test would not see an index that names everything";
}

TEST(BallLookup, NamesEveryBallThatHoldsAPoint) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    expect_names_all_that_hold({0, 0, 0}, seed);
    expect_names_all_that_hold({5e5, -5e6, 100}, seed);
  }
}

TEST(BallLookup, NamesBallsThatAreSmallerThanTheGapsBetweenDoubles) {
  const double far = 1e12, next = std::nextafter(far, 2 * far);
  for (const double reach : {1e-9, (next - far) / 2, next - far, 3 * (next - far)}) {
    const std::vector<Ball> balls = {{{far, far, far}, reach * reach}};
    const BallLookup index(balls);
    for (double x = far - 8 * (next - far); x <= far + 8 * (next - far); x += next - far) {
      if (distance2(Vec3{x, far, far}, balls[0].center) > balls[0].reach2) continue;
      EXPECT_EQ(named(index, {x, far, far}).size(), 1u);
      EXPECT_TRUE(BallCover(balls).covers({x, far, far}));
    }
  }
}

TEST(BallLookup, OfNoBallsNamesNone) {
  EXPECT_TRUE(named(BallLookup({}), {1, 2, 3}).empty());
  EXPECT_FALSE(BallCover({}).covers({1, 2, 3}));
}

TEST(BallCover, CoversNothingFartherThanTheWidthOfABall) {
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 20000; ++i) {
    const Ball ball{{uniform(rng), uniform(rng), uniform(rng)}, std::pow(0.3 * uniform(rng), 2)};
    const Vec3 p{uniform(rng), uniform(rng), uniform(rng)};
    const Vec3 away{std::abs(p.x - ball.center.x), std::abs(p.y - ball.center.y), std::abs(p.z - ball.center.z)};
    const bool is_far = std::max({away.x, away.y, away.z}) > 3.0001 * std::sqrt(ball.reach2);
    ASSERT_FALSE(is_far && BallCover({&ball, 1}).covers(p));
  }
}

}  // namespace
}  // namespace pointsweep
