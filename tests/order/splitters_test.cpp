// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "pointsweep/order/pieces.h"

namespace pointsweep {
namespace {

constexpr double kMax = std::numeric_limits<double>::max();

rc::Gen<double> finite_number() {
  return rc::gen::oneOf(rc::gen::map(rc::gen::inRange(-50, 50), [](int i) { return 0.125 * i; }),
                        rc::gen::map(rc::gen::inRange(-5, 5), [](int i) { return 1e6 + 1e-9 * i; }),
                        rc::gen::suchThat(rc::gen::arbitrary<double>(), [](double v) { return std::isfinite(v); }),
                        rc::gen::element(0.0, -0.0, 5e-324, -5e-324, kMax, -kMax));
}

TEST(Splitters, FindThePieceThatABinarySearchFinds) {
  rc::check([] {
    const auto numbers = *rc::gen::container<std::vector<double>>(finite_number());
    const std::set<double> unlike(numbers.begin(), numbers.end());
    const std::vector<double> limits(unlike.begin(), unlike.end());
    const Splitters splitters(limits);
    RC_ASSERT(splitters.pieces() == limits.size() + 1);
    std::vector<double> values = *rc::gen::container<std::vector<double>>(finite_number());
    for (const double limit : limits)
      for (const double v : {limit, std::nextafter(limit, kMax), std::nextafter(limit, -kMax)}) values.push_back(v);
    for (const double v : values) {
      const auto expected = std::upper_bound(limits.begin(), limits.end(), v) - limits.begin();
      RC_ASSERT(splitters.piece_of(v) == static_cast<std::uint32_t>(expected));
    }
  });
}

TEST(Splitters, MayBeManyAndUnevenlySpread) {
  std::vector<double> limits;
  for (int i = 0; i < 30000; ++i) limits.push_back(i < 29000 ? 1 + 1e-10 * i : i);
  const Splitters splitters(limits);
  for (std::size_t i = 0; i < limits.size(); ++i) {
    ASSERT_EQ(splitters.piece_of(limits[i]), i + 1);
    ASSERT_EQ(splitters.piece_of(std::nextafter(limits[i], -kMax)), i);
  }
}

TEST(QuantileLimits, CutASampleInEqualParts) {
  std::vector<double> sample;
  for (int i = 0; i < 1000; ++i) sample.push_back(i * 7 % 1000);
  EXPECT_EQ(quantile_limits(sample, 4), (std::vector<double>{250, 500, 750}));
}

TEST(QuantileLimits, GiveAFrequentValueAPieceOfItsOwn) {
  std::vector<double> sample(600, 5.0);
  for (int i = 0; i < 400; ++i) sample.push_back(i);
  const std::vector<double> limits = quantile_limits(sample, 10);
  const auto at = std::ranges::find(limits, 5.0);
  ASSERT_NE(at, limits.end());
  ASSERT_NE(at + 1, limits.end());
  EXPECT_EQ(at[1], std::nextafter(5.0, 6.0));
  EXPECT_TRUE(std::ranges::is_sorted(limits));
  EXPECT_EQ(std::ranges::adjacent_find(limits), limits.end());
}

TEST(LimitsNotTooNear, LeaveNoPieceThinnerThanFourSpacings) {
  // A wall of thickness 0.05 at 1 stands on ground. The points of both are 0.1 apart.
  std::vector<double> sample;
  for (int i = 0; i < 1000; ++i) sample.push_back(i < 500 ? 1 + i * 1e-4 : (i - 500) * 0.01);
  const std::vector<double> spacing(sample.size(), 0.1);
  const std::vector<double> wanted{0.5, 1, 1.01, 1.02, 1.03, 1.5, 1.6, 2, 4};
  EXPECT_EQ(limits_not_too_near(wanted, sample, spacing), (std::vector<double>{0.5, 1, 1.5, 2, 4}));
  EXPECT_EQ(limits_not_too_near(wanted, sample, std::vector<double>(sample.size(), 1e-4)), wanted);
  EXPECT_EQ(limits_not_too_near(wanted, sample, {}), wanted) << "nothing is known";
}

TEST(LimitsNotTooNear, FollowTheSpacingOfEachPiece) {
  std::vector<double> sample, spacing;
  for (int i = 0; i < 1000; ++i) sample.push_back(i), spacing.push_back(i < 500 ? 1 : 10);
  const std::vector<double> wanted{10, 20, 500, 510, 520, 530, 540, 550, 560};
  EXPECT_EQ(limits_not_too_near(wanted, sample, spacing), (std::vector<double>{10, 20, 500, 540}));
}

TEST(QuantileLimits, OfNothingAreNone) {
  std::vector<double> sample;
  EXPECT_TRUE(quantile_limits(sample, 10).empty());
  EXPECT_EQ(Splitters().pieces(), 1u);
  EXPECT_EQ(Splitters().piece_of(-3), 0u);
}

}  // namespace
}  // namespace pointsweep
