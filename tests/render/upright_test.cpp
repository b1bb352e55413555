// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "pointsweep/render/view.h"

namespace pointsweep {
namespace {

/// Converts p from a frame with z up to a frame with `up` up (handedness does not matter here).
Vec3 turned(Vec3 p, Up up) {
  Vec3 q;
  q[up.axis] = up.sign * p.z;
  q[(up.axis + 1) % 3] = p.x;
  q[(up.axis + 2) % 3] = p.y;
  return q;
}

std::vector<Vec3> turned(std::vector<Vec3> cloud, Up up) {
  for (Vec3& p : cloud) p = turned(p, up);
  return cloud;
}

constexpr Up kAll[] = {{0, 1}, {1, 1}, {2, 1}, {0, -1}, {1, -1}, {2, -1}};

/// Returns points of a vase: the surface of a box of size a × b × c without its top, and a knob above it.
std::vector<Vec3> vase() {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> in(0, 1);
  std::normal_distribution<double> normal;
  std::vector<Vec3> cloud;
  for (int i = 0; i < 4000; ++i) cloud.push_back({in(random), in(random), 0});
  for (int i = 0; i < 20000; ++i) {
    const Vec3 n{normal(random), normal(random), normal(random)};
    const Vec3 p = (1 / length(n)) * n;
    cloud.push_back({0.5 + 0.3 * p.x, 0.5 + 0.3 * p.y, 0.5 + 0.5 * p.z});
  }
  return cloud;
}

TEST(Upright, AnObjectStandsOnItsFoot) {
  for (const Up up : kAll) EXPECT_EQ(find_up(turned(vase(), up)), up) << up.axis << " " << up.sign;
}

TEST(Upright, AFootThatIsOnlyARingCountsAsWhole) {
  std::vector<Vec3> cloud = vase();
  std::erase_if(cloud, [](Vec3 p) { return p.z == 0 && p.x > 0.1 && p.x < 0.9 && p.y > 0.1 && p.y < 0.9; });
  EXPECT_EQ(find_up(turned(cloud, {1, 1})), (Up{1, 1}));
}

TEST(Upright, WhatHasNoFootHasZUp) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<Vec3> ball, cube;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 n{normal(random), normal(random), normal(random)};
    ball.push_back((1 / length(n)) * n);
    cube.push_back({std::fmod(n.x * 1000, 1), std::fmod(n.y * 1000, 1), std::fmod(n.z * 1000, 1)});
  }
  EXPECT_EQ(find_up(ball), Up{});
  EXPECT_EQ(find_up(cube), Up{}) << "all sides alike";
  EXPECT_EQ(find_up({}), Up{});
  EXPECT_EQ(find_up(std::vector<Vec3>(3, Vec3{1, 2, 3})), Up{});
}

TEST(Upright, AFlatCloudIsSeenAcross) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> in(0, 1);
  std::vector<Vec3> map;
  for (int i = 0; i < 20000; ++i) map.push_back({1000 * in(random), 600 * in(random), 90 * in(random)});
  for (const int axis : {0, 1, 2}) {
    const std::vector<Vec3> cloud = turned(map, {axis, 1});
    EXPECT_EQ(find_up(cloud), (Up{axis, 1}));
    EXPECT_TRUE(is_flat(cloud, Up{axis, 1}));
    EXPECT_FALSE(is_flat(cloud, Up{(axis + 1) % 3, 1}));
  }
  EXPECT_FALSE(is_flat(vase(), {}));
}

TEST(Upright, AFewPointsFarAwayChangeNothing) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> in(0, 1);
  std::vector<Vec3> map;
  for (int i = 0; i < 20000; ++i) map.push_back({1000 * in(random), 600 * in(random), 90 * in(random)});
  for (int i = 0; i < 10; ++i) map.push_back({500, 300, i % 2 == 0 ? 9e4 : -9e4});
  EXPECT_TRUE(is_flat(map, {}));
  EXPECT_EQ(find_up(map), Up{});
}

}  // namespace
}  // namespace pointsweep
