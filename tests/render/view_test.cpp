// SPDX-License-Identifier: MIT
#include "pointsweep/render/view.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pointsweep/error.h"

namespace pointsweep {
namespace {

void expect_near(Vec3 a, Vec3 b) {
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(a[axis], b[axis], 1e-12);
}

Camera camera(const char* view, Up up) { return camera_of({*parse_view(view), up}, {}, 100, 50); }
Camera camera(const char* view, int axis) { return camera(view, Up{axis}); }

TEST(View, TheFrontShowsXToTheRightAndZUp) {
  const Camera c = camera("front", 2);
  expect_near(c.right, {1, 0, 0});
  expect_near(c.up, {0, 0, 1});
  expect_near(c.toward, {0, -1, 0});
}

TEST(View, TheTopShowsAMap) {
  const Camera c = camera("top", 2);
  expect_near(c.right, {1, 0, 0});
  expect_near(c.up, {0, 1, 0});
  expect_near(c.toward, {0, 0, 1});
}

TEST(View, AzimuthWalksAroundTheCloudToItsRight) {
  expect_near(camera("90,0", 2).toward, {1, 0, 0});
  expect_near(camera("180,0", 2).toward, {0, 1, 0});
  expect_near(camera("-90,0", 2).toward, {-1, 0, 0});
  expect_near(camera("450,0", 2).toward, {1, 0, 0});
}

TEST(View, AnotherAxisMayPointUp) {
  expect_near(camera("front", 1).up, {0, 1, 0});
  expect_near(camera("front", 1).right, {1, 0, 0});
  expect_near(camera("front", 1).toward, {0, 0, 1});
  expect_near(camera("front", 0).up, {1, 0, 0});
  expect_near(camera("front", 0).right, {0, 1, 0});
}

TEST(View, ANegativeAxisTurnsTheCloudUpsideDown) {
  for (int axis = 0; axis < 3; ++axis) {
    const Camera up = camera("front", Up{axis, 1}), down = camera("front", Up{axis, -1});
    expect_near(down.up, -1.0 * up.up);
    expect_near(down.right, up.right);
  }
}

TEST(View, AutomaticMeansChosenFromTheCloud) {
  EXPECT_EQ(parse_view("auto"), std::nullopt);
  EXPECT_EQ(parse_up("auto"), std::nullopt);
  EXPECT_EQ(parse_up("y"), (Up{1, 1}));
  EXPECT_EQ(parse_up("-x"), (Up{0, -1}));
  for (const char* text : {"", "-", "w", "+z", "zz", "Z"}) EXPECT_THROW(parse_up(text), UsageError) << text;
}

TEST(View, CamerasAreOrthonormalAndRightHanded) {
  for (const char* view : {"front", "top", "iso", "17,-63", "-200.5,89"}) {
    for (const Up up : {Up{0, 1}, Up{1, 1}, Up{2, 1}, Up{0, -1}, Up{1, -1}, Up{2, -1}}) {
      const Camera c = camera(view, up);
      EXPECT_NEAR(length(c.right), 1, 1e-12);
      EXPECT_NEAR(dot(c.up, c.toward), 0, 1e-12);
      expect_near(cross(c.right, c.up), c.toward);
    }
  }
}

TEST(View, IsoSeesTheThreeAxesEquallyLong) {
  const Camera c = camera("iso", 2);
  EXPECT_NEAR(std::abs(c.toward.x), std::abs(c.toward.y), 1e-12);
  EXPECT_NEAR(std::abs(c.toward.x), c.toward.z, 1e-12);
}

TEST(View, FramingFillsTheTighterSide) {
  Camera c = camera("front", 2);
  frame(c, -1, 3, 10, 11);
  const Vec3 left = c.project({-1, 0, 10.5}), right = c.project({3, 0, 10.5}), top = c.project({1, 0, 11});
  EXPECT_NEAR(left.x, 3, 1e-9);
  EXPECT_NEAR(right.x, 97, 1e-9);
  EXPECT_NEAR(left.y, 25, 1e-9);
  EXPECT_LT(top.y, 25);
  EXPECT_GT(c.project({0, -1, 10}).z, c.project({0, 1, 10}).z);
}

TEST(View, ASinglePointIsInTheMiddle) {
  Camera c = camera("front", 2);
  frame(c, 5, 5, 7, 7);
  expect_near(c.project({5, 0, 7}), {50, 25, 0});
}

TEST(View, RefusesWhatIsNoView) {
  for (const char* text : {"", "back", "10", "10,", "10,91", "nan,0", "1,2,3", "1 ,2"}) {
    EXPECT_THROW(parse_view(text), UsageError) << text;
  }
}

}  // namespace
}  // namespace pointsweep
