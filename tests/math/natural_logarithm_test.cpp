// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "pointsweep/math/batch.h"
#include "pointsweep/math/exp.h"
#include "tests/support/instruction_sets.h"

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

TEST(NaturalLogarithm, HasTheSameBitsInEveryLaneOfEveryInstructionSet) {
  std::vector<double> x = {1,
                           2,
                           0.5,
                           1.4142135623730951,
                           std::nextafter(1.4142135623730951, 2),
                           std::numeric_limits<double>::min(),
                           std::numeric_limits<double>::max()};
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> mantissa(1, 2);
  std::uniform_int_distribution<int> exponent(-1022, 1023);
  for (int i = 0; i < 100'000; ++i) x.push_back(std::ldexp(mantissa(random), exponent(random)));
  for_each_instruction_set([&] {
    std::vector<double> found(x.size());
    batch_natural_logarithm(x, found);
    for (std::size_t i = 0; i < x.size(); ++i)
      ASSERT_EQ(std::bit_cast<std::uint64_t>(found[i]), std::bit_cast<std::uint64_t>(natural_logarithm(x[i]))) << x[i];
  });
}

}  // namespace
}  // namespace pointsweep
