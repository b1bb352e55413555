// SPDX-License-Identifier: MIT
#include "pointsweep/math/exp.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "pointsweep/math/batch.h"
#include "tests/support/instruction_sets.h"

namespace pointsweep {
namespace {

std::vector<double> arguments() {
  std::vector<double> x{0.0,    1e-300, 1e-17,    0.34657359, 0.346573591, 1,
                        707.99, 708,    708.0001, 1e6,        1e300,       std::numeric_limits<double>::infinity()};
  std::mt19937_64 random(20051);
  std::uniform_real_distribution<double> wide(0, 708), middle(0, 87), narrow(0, 2);
  for (int i = 0; i < 100000; ++i)
    x.push_back(i % 3 == 0 ? wide(random) : i % 3 == 1 ? middle(random) : narrow(random));
  return x;
}

TEST(ExpNegative, IsWithinOneUlp) {
  for (const double x : arguments()) {
    if (x > 708) continue;
    const double found = exp_negative(x);
    const double ulp = std::nextafter(found, 2.0) - found;
    EXPECT_LE(std::abs((long double)(found)-std::exp(-(long double)(x))), 1.0L * ulp) << x;
  }
}

TEST(ExpNegative, IsOneAtZeroAndZeroFarAway) {
  EXPECT_EQ(exp_negative(0.0), 1);
  EXPECT_EQ(exp_negative(-0.0), 1);
  EXPECT_GT(exp_negative(708.0), 0);
  EXPECT_EQ(exp_negative(std::nextafter(708.0, 1e9)), 0);
  EXPECT_EQ(exp_negative(std::numeric_limits<double>::infinity()), 0);
}

TEST(ExpNegative, HasTheSameBitsInEveryLaneOfEveryInstructionSet) {
  const std::vector<double> x = arguments();
  for_each_instruction_set([&] {
    std::vector<double> found(x.size());
    batch_exp_negative(x, found);
    for (std::size_t i = 0; i < x.size(); ++i)
      ASSERT_EQ(std::bit_cast<std::uint64_t>(found[i]), std::bit_cast<std::uint64_t>(exp_negative(x[i]))) << x[i];
  });
}

TEST(ExpNegativeInSinglePrecision, IsWithinTwoUlps) {
  for (const double argument : arguments()) {
    const float x = static_cast<float>(argument);
    if (x > 87) continue;
    const float found = exp_negative(x);
    const double ulp = std::nextafter(found, 2.0f) - found;
    EXPECT_LE(std::abs(found - std::exp(-double(x))), 2 * ulp) << x;
  }
}

TEST(ExpNegativeInSinglePrecision, IsOneAtZeroAndZeroFarAway) {
  EXPECT_EQ(exp_negative(0.0f), 1);
  EXPECT_GT(exp_negative(87.0f), 0);
  EXPECT_EQ(exp_negative(std::nextafter(87.0f, 1e9f)), 0);
  EXPECT_EQ(exp_negative(std::numeric_limits<float>::infinity()), 0);
}

}  // namespace
}  // namespace pointsweep
