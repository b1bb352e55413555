// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las_scale.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace pointsweep {
namespace {

TEST(LasScale, ReachesBothEndsAndLosesLessThanPromised) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(-1, 1), exponent(-8, 9);
  for (int round = 0; round < 3000; ++round) {
    const double center = unit(random) * std::pow(10, exponent(random));
    const double half = std::abs(unit(random)) * std::pow(10, exponent(random));
    Box box;
    box.include(Vec3{center - half, -half, center});
    box.include(Vec3{center + half, half, center + half});
    const LasQuantization q = las_quantization(box);
    for (int axis = 0; axis < 3; ++axis) {
      const double extent = box.hi[axis] - box.lo[axis];
      const double largest = std::max(std::abs(box.lo[axis]), std::abs(box.hi[axis]));
      ASSERT_LT(std::abs(box.lo[axis] - q.offset[axis]) / q.scale[axis], 2147483647);
      ASSERT_LT(std::abs(box.hi[axis] - q.offset[axis]) / q.scale[axis], 2147483647);
      // Steps finer than the spacing of doubles, or than 10^-12 of the cloud, are useless. The error is half a step.
      const double useful = std::max(largest * 2.3e-16, half * 1e-12);
      ASSERT_LE(q.scale[axis] / 2, std::max(1.3e-9 * extent, 10 * useful)) << extent << " " << largest;
    }
  }
}

TEST(LasScale, IsARoundNumberAtARoundPlace) {
  Box box;
  box.include(Vec3{636000.13, 848935.2, 406.26});
  box.include(Vec3{638994.75, 853535.43, 615.26});
  const LasQuantization q = las_quantization(box);
  EXPECT_EQ(q.scale, (Vec3{1e-6, 1e-5, 1e-7}));
  EXPECT_EQ(q.offset, (Vec3{637500, 851200, 510}));
}

TEST(LasScale, OfASinglePointIsExact) {
  Box box;
  box.include(Vec3{0, 4500000.123456789, -1e-9});
  const LasQuantization q = las_quantization(box);
  EXPECT_EQ(q.offset, box.lo);
  EXPECT_GT(q.scale.x, 1e-12);
  EXPECT_LE(q.scale.x, 1e-9);
}

TEST(LasScale, SurvivesTheEndsOfTheDoubles) {
  constexpr double kMost = 1.7e308;
  Box box;
  box.include(Vec3{-kMost, kMost, -5e-324});
  box.include(Vec3{kMost, kMost, 5e-324});
  const LasQuantization q = las_quantization(box);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_TRUE(std::isfinite(q.scale[axis]) && q.scale[axis] > 0);
    EXPECT_TRUE(std::isfinite(q.offset[axis]));
  }
}

}  // namespace
}  // namespace pointsweep
