// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "pointsweep/math/exp.h"

namespace pointsweep {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

void expect_near(double value, long double truth, double argument) {
  const long double bound = 8 * 0x1p-53L * std::fabs(truth) + 0x1p-1074L;
  ASSERT_LE(std::fabs(static_cast<long double>(value) - truth), bound) << argument;
}

TEST(Elementary, ErrorsAreAtMostEightUlps) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> sign(-1, 1), exponent(-1074, 1023);
  for (int i = 0; i < 200'000; ++i) {
    const double x = i % 2 ? 745 * sign(random) : sign(random) * std::exp2(exponent(random) / 100);
    const double size = i % 2 ? std::exp2(exponent(random)) : 1 + sign(random) / 2;
    const double other = i % 3 ? sign(random) : std::exp2(exponent(random));
    if (x < 709.7) expect_near(exponential(x), std::exp(static_cast<long double>(x)), x);
    expect_near(logarithm(size), std::log(static_cast<long double>(size)), size);
    expect_near(arctangent2(x, other), std::atan2(static_cast<long double>(x), static_cast<long double>(other)), x);
  }
}

TEST(Elementary, EndsAreThoseOfC) {
  for (const double x : {0.0, -0.0, 710.0, -746.0, kInfinite, -kInfinite}) EXPECT_EQ(exponential(x), std::exp(x)) << x;
  for (const double x : {0.0, -0.0, 1.0, kInfinite}) EXPECT_EQ(logarithm(x), std::log(x)) << x;
  for (const double x : {-1.0, -kInfinite, kNaN}) EXPECT_TRUE(std::isnan(logarithm(x))) << x;
  EXPECT_TRUE(std::isnan(exponential(kNaN)));
  for (const double y : {0.0, -0.0, 1.0, -1.0, kInfinite, -kInfinite, kNaN})
    for (const double x : {0.0, -0.0, 1.0, -1.0, kInfinite, -kInfinite, kNaN}) {
      const double angle = arctangent2(y, x), truth = std::atan2(y, x);
      EXPECT_TRUE(std::isnan(truth) ? std::isnan(angle) : std::fabs(angle - truth) < 1e-15) << y << " " << x;
      EXPECT_TRUE(std::isnan(truth) || std::signbit(angle) == std::signbit(truth)) << y << " " << x;
    }
}

}  // namespace
}  // namespace pointsweep
