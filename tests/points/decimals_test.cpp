// SPDX-License-Identifier: MIT
#include "pointsweep/points/decimals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>
#include <string>

namespace pointsweep {
namespace {

TEST(Decimals, AreThoseOfTheShortestTextThatMeansTheNumber) {
  EXPECT_EQ(decimals_of(0), 0);
  EXPECT_EQ(decimals_of(-17), 0);
  EXPECT_EQ(decimals_of(684992.57), 2);
  EXPECT_EQ(decimals_of(1e-9), 9);
  EXPECT_EQ(decimals_of(684992.5700000001), std::nullopt);
  EXPECT_EQ(decimals_of(1.0 / 3), std::nullopt);
}

TEST(Decimals, OfAGridAreTheNumbersThatItsIntegersMean) {
  std::mt19937_64 random(3);
  std::size_t cleaned = 0;
  for (const auto& [scale, bias, digits] :
       {std::tuple{0.01, 0.0, 2}, std::tuple{0.001, 500000.0, 3}, std::tuple{0.00025, -3.5, 5}, std::tuple{0.5, 0.125, 3}}) {
    const GridDecimals decimals({.name = "x", .type = Type::i32, .scale = scale, .bias = bias});
    for (int i = 0; i < 2000; ++i) {
      const double read = static_cast<std::int32_t>(random()) * scale + bias;
      char text[64];
      std::snprintf(text, sizeof text, "%.*f", digits, read);  // the C library rounds decimally
      ASSERT_EQ(decimals.of(read), std::strtod(text, nullptr)) << text;
      cleaned += decimals.of(read) != read ? 1 : 0;
    }
  }
  EXPECT_GT(cleaned, 0u);
}

TEST(Decimals, OtherNumbersStay) {
  const GridDecimals thirds({.name = "x", .type = Type::i32, .scale = 1.0 / 3}),
      real({.name = "x", .type = Type::f64}), fine({.name = "x", .type = Type::i32, .scale = 0.01, .bias = 1.0 / 3});
  for (const double value : {684992.5700000001, 1.0 / 3, 0.01 + 1.0 / 3}) {
    EXPECT_EQ(thirds.of(value), value);
    EXPECT_EQ(real.of(value), value);
  }
  EXPECT_EQ(fine.of(0.01 + 1.0 / 3), 0.01 + 1.0 / 3);
}

}  // namespace
}  // namespace pointsweep
