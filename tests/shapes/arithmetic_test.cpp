// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>

#include "pointsweep/shapes/rng.h"

namespace pointsweep {
namespace {

TEST(Wave, RepeatsAndItsSlopeIsItsDerivative) {
  Rng rng(2, 0);
  for (int i = 0; i < 10'000; ++i) {
    const double t = rng.uniform(-3, 3), h = 1e-6;
    const WaveValue w = wave(t);
    ASSERT_LE(std::abs(w.value), 1);
    ASSERT_NEAR(wave(t + 1).value, w.value, 1e-12);
    ASSERT_NEAR((wave(t + h).value - wave(t - h).value) / (2 * h), w.slope, 1e-6) << t;
  }
}

TEST(Wave, SlopeIsContinuousWhereThePeriodsMeet) {
  EXPECT_NEAR(wave(0.5 - 1e-9).slope, wave(0.5 + 1e-9).slope, 1e-6);
  EXPECT_NEAR(wave(-1e-9).slope, wave(1e-9).slope, 1e-6);
}

TEST(Rng, StreamsOfNeighboringIndicesAreUnrelated) {
  double sum = 0;
  const int n = 100'000;
  for (std::uint64_t i = 0; i < n; ++i) sum += (Rng(1, i).uniform() - 0.5) * (Rng(1, i + 1).uniform() - 0.5);
  EXPECT_NEAR(sum / n, 0, 5 / 12.0 / std::sqrt(n));
}

}  // namespace
}  // namespace pointsweep
