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

TEST(Decimals, OfAllValuesAreACommonStep) {
  const auto step = [](std::vector<double> values, int times = 100) {
    CommonStep common;
    for (int i = 0; i < times; ++i)
      for (const double value : values) EXPECT_TRUE(common.take(value)) << value;
    return common.size();
  };
  EXPECT_EQ(step({684992.57, 1, -3.1}), 0.01);
  EXPECT_EQ(step({1.00025, -0.0005, 7}), 0.00025);
  EXPECT_EQ(step({-0.0005, 7, 1.00025}), 0.00025) << "in any order";
  EXPECT_EQ(step({0.5, 0.75}), 0.25);
  EXPECT_EQ(step({0.5, 0.75}, 20), 0.01) << "a few may be multiples by chance";
  EXPECT_EQ(step({5e9, -7e12}), 1) << "no scale above 1";
  EXPECT_EQ(step({0, 1e-9}), 1e-9);
  EXPECT_EQ(step({9007199254740993.0, 0.5}), 0.1) << "beyond 2^53 tenths";
  CommonStep common;
  EXPECT_TRUE(common.empty());
  EXPECT_FALSE(common.take(1.0 / 3));
}

TEST(Decimals, OfAGridAreTheNumbersThatItsIntegersMean) {
  std::mt19937_64 random(3);
  std::size_t cleaned = 0;
  for (const auto& [scale, bias, digits] : {std::tuple{0.01, 0.0, 2}, std::tuple{0.001, 500000.0, 3},
                                            std::tuple{0.00025, -3.5, 5}, std::tuple{0.5, 0.125, 3}}) {
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
  const GridDecimals thirds({.name = "x", .type = Type::i32, .scale = 1.0 / 3}), real({.name = "x", .type = Type::f64}),
      fine({.name = "x", .type = Type::i32, .scale = 0.01, .bias = 1.0 / 3});
  for (const double value : {684992.5700000001, 1.0 / 3, 0.01 + 1.0 / 3}) {
    EXPECT_EQ(thirds.of(value), value);
    EXPECT_EQ(real.of(value), value);
  }
  EXPECT_EQ(fine.of(0.01 + 1.0 / 3), 0.01 + 1.0 / 3);
}

}  // namespace
}  // namespace pointsweep
