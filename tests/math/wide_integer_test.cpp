// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pointsweep/math/exact_sum.h"

namespace pointsweep {
namespace {

/// Returns a random integer of up to `bits` bits, of either sign.
Int128 number(std::mt19937_64& random, int bits) {
  const auto wide = static_cast<Int128>(static_cast<UInt128>(random()) << 64 | random());
  return wide >> (128 - bits);
}

TEST(Int192, IsThatOf128BitsWhereTheseHoldIt) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 20'000; ++i) {
    const int bits = 2 + static_cast<int>(random() % 61);
    const Int128 a = number(random, bits), b = number(random, bits), c = number(random, 100);
    const Int192 value = Int192::product(a, b) - c;
    const Int128 expected = a * b - c;
    ASSERT_NEAR(static_cast<double>(value), static_cast<double>(expected),
                std::abs(static_cast<double>(expected)) * 0x1p-51);
    ASSERT_EQ(static_cast<double>(value - expected), 0);
  }
}

/// Checks (a + b)² - a² - 2ab = b² with squares of 162 bits, and the sign of negated values.
TEST(Int192, CancelsSquaresExactly) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 20'000; ++i) {
    const Int128 a = number(random, 81), b = number(random, 1 + static_cast<int>(random() % 80));
    const Int192 rest = Int192::product(a + b, a + b) - Int192::product(a, a) - Int192::product(2 * a, b);
    const auto side = static_cast<double>(b);
    ASSERT_NEAR(static_cast<double>(rest), side * side, side * side * 0x1p-50);
    ASSERT_EQ(static_cast<double>(rest - Int192::product(b, b)), 0);
    ASSERT_EQ(static_cast<double>(-rest), -static_cast<double>(rest));
  }
}

TEST(Int192, IsRightWhereSumsOnTheWayAreTooLarge) {
  const Int192 large = Int192::product(Int128{1} << 100, Int128{1} << 90);  // 2^190
  Int192 sum;
  for (int i = 0; i < 7; ++i) sum += large;
  for (int i = 0; i < 6; ++i) sum += -large;
  EXPECT_EQ(static_cast<double>(sum), 0x1p190);
  EXPECT_EQ(static_cast<double>(-sum), -0x1p190);
}

}  // namespace
}  // namespace pointsweep
