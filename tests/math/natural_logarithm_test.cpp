// SPDX-License-Identifier: MIT
#include "pointsweep/math/natural_logarithm.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace pointsweep {
namespace {

TEST(NaturalLogarithm, AgreesWithTheCLibrary) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> mantissa(1, 2);
  std::uniform_int_distribution<int> exponent(-1022, 1023);
  for (int i = 0; i < 100'000; ++i) {
    const double x = std::ldexp(mantissa(random), i % 2 ? exponent(random) : exponent(random) / 500);
    ASSERT_NEAR(natural_logarithm(x), std::log(x), 1e-13 * std::max(0.01, std::abs(std::log(x)))) << x;
  }
  EXPECT_EQ(natural_logarithm(1), 0);
  EXPECT_NEAR(natural_logarithm(std::numeric_limits<double>::min()), std::log(std::numeric_limits<double>::min()),
              1e-10);
}

}  // namespace
}  // namespace pointsweep
