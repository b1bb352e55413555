// SPDX-License-Identifier: MIT
/// Exact sums against sums of big integers, added digit by digit in base 2.
#include "pointsweep/math/exact_sum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace pointsweep {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kDenormal = std::numeric_limits<double>::denorm_min();
constexpr double kLargest = std::numeric_limits<double>::max();

/// A sum as signed counts of powers of two from 2^-2200 on, one count for each bit: slow and obvious.
class BitCounts {
 public:
  void add(double value, int doublings = 0) {
    int exponent = 0;
    const double fraction = std::frexp(std::abs(value), &exponent);
    auto mantissa = static_cast<std::uint64_t>(std::ldexp(fraction, 53));
    for (int bit = exponent - 53 + doublings; mantissa != 0; ++bit, mantissa >>= 1)
      if (mantissa & 1) counts_[static_cast<std::size_t>(bit + kShift)] += std::signbit(value) ? -1 : 1;
  }
  /// Adds the product: for each bit of b, a shifted by its place.
  void add_product(double a, double b) {
    int exponent = 0;
    const double fraction = std::frexp(std::abs(b), &exponent);
    auto mantissa = static_cast<std::uint64_t>(std::ldexp(fraction, 53));
    for (int bit = exponent - 53; mantissa != 0; ++bit, mantissa >>= 1)
      if (mantissa & 1) add(std::signbit(b) ? -a : a, bit);
  }
  double rounded() {
    std::vector<long> bits = carried();
    const bool negative = bits.back() < 0;
    if (negative) {
      for (long& count : counts_) count = -count;
      bits = carried();
    }
    int top = static_cast<int>(bits.size()) - 1;
    while (top >= 0 && bits[static_cast<std::size_t>(top)] == 0) --top;
    if (top < 0) return 0;
    const int last = std::max(top - 52, kShift - 1074);
    double value = 0;
    for (int b = top; b >= last; --b) value += bits[static_cast<std::size_t>(b)] != 0 ? std::ldexp(1.0, b - kShift) : 0;
    const bool half = bits[static_cast<std::size_t>(last - 1)] != 0;
    const bool more = std::any_of(bits.begin(), bits.begin() + last - 1, [](long b) { return b != 0; });
    if (half && (more || bits[static_cast<std::size_t>(last)] != 0)) value += std::ldexp(1.0, last - kShift);
    return negative ? -value : value;
  }

 private:
  static constexpr int kShift = 2200;
  std::vector<long> carried() const {
    std::vector<long> bits = counts_;
    for (std::size_t i = 0; i + 1 < bits.size(); ++i) {
      const long above = bits[i] >> 1;
      bits[i] -= 2 * above;
      bits[i + 1] += above;
    }
    return bits;
  }
  std::vector<long> counts_ = std::vector<long>(4400, 0);
};

double sum_of(const std::vector<double>& terms) {
  ExactSum sum;
  for (const double t : terms) sum.add(t);
  return sum.rounded();
}

double by_bits(const std::vector<double>& terms) {
  BitCounts counts;
  for (const double t : terms) counts.add(t);
  return counts.rounded();
}

/// Returns doubles of all magnitudes below 1e300 and both signs, including denormals.
std::vector<double> of_all_magnitudes(std::size_t n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<double> values;
  while (values.size() < n) {
    const double v = std::bit_cast<double>(random());
    if (std::isfinite(v) && std::abs(v) < 1e300) values.push_back(v);
  }
  return values;
}

TEST(ExactSum, OfNothingIsZero) {
  EXPECT_EQ(ExactSum().rounded(), 0);
  EXPECT_FALSE(std::signbit(ExactSum().rounded()));
  EXPECT_FALSE(std::signbit(sum_of({-0.0})));
}

TEST(ExactSum, OfOneTermIsTheTerm) {
  for (const double v : {1.0, -1.0, 0.1, kDenormal, -kDenormal, 3 * kDenormal, kLargest, -kLargest, 0x1p-1022, 1e-310})
    EXPECT_EQ(std::bit_cast<std::uint64_t>(sum_of({v})), std::bit_cast<std::uint64_t>(v)) << v;
}

TEST(ExactSum, SurvivesCancellation) {
  EXPECT_EQ(sum_of({1e16, 1, -1e16}), 1);
  EXPECT_EQ(sum_of({1e300, kDenormal, -1e300}), kDenormal);
  EXPECT_EQ(sum_of({0.1, 0.2, -0.3}), 0x1p-55);
  EXPECT_EQ(sum_of({kLargest, kLargest, -kLargest}), kLargest);
  EXPECT_EQ(sum_of({0x1p-1022, -0x1p-1022}), 0);
}

TEST(ExactSum, RoundsTiesToEvenAndLooksAtEveryBitBelow) {
  EXPECT_EQ(sum_of({1, 0x1p-53}), 1);
  EXPECT_EQ(sum_of({1, 0x1p-53, kDenormal}), 1 + 0x1p-52);
  EXPECT_EQ(sum_of({1 + 0x1p-52, 0x1p-53}), 1 + 0x1p-51);
  EXPECT_EQ(sum_of({1 + 0x1p-52, 0x1p-53, -kDenormal}), 1 + 0x1p-52);
  EXPECT_EQ(sum_of({-1, -0x1p-53, -kDenormal}), -1 - 0x1p-52);
}

TEST(ExactSum, BeyondTheLargestDoubleIsInfinite) {
  EXPECT_EQ(sum_of({kLargest, kLargest}), kInfinity);
  EXPECT_EQ(sum_of({-kLargest, -kLargest}), -kInfinity);
  EXPECT_EQ(sum_of({kLargest, std::ldexp(1.0, 969)}), kLargest);
  EXPECT_EQ(sum_of({kLargest, std::ldexp(1.0, 970)}), kInfinity);
}

TEST(ExactSum, OfInfinitiesAndNaN) {
  EXPECT_EQ(sum_of({1, kInfinity, 2}), kInfinity);
  EXPECT_EQ(sum_of({1, -kInfinity, 1e300}), -kInfinity);
  EXPECT_TRUE(std::isnan(sum_of({kInfinity, -kInfinity})));
  EXPECT_TRUE(std::isnan(sum_of({1, std::numeric_limits<double>::quiet_NaN(), kInfinity})));
  ExactSum product;
  product.add_product(0, kInfinity);
  EXPECT_TRUE(std::isnan(product.rounded()));
}

TEST(ExactSum, EqualsTheSumOfBits) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    std::vector<double> terms = of_all_magnitudes(200, seed);
    if (seed % 2 == 0)  // cancels 190 of 200 terms, so that the others decide
      for (std::size_t i = 0; i < 190; ++i) terms.push_back(-terms[i]);
    EXPECT_EQ(sum_of(terms), by_bits(terms)) << "seed " << seed;
  }
}

TEST(ExactSum, OfProductsEqualsTheSumOfBits) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const std::vector<double> a = of_all_magnitudes(60, seed), b = of_all_magnitudes(60, seed + 100);
    ExactSum sum;
    BitCounts counts;
    for (std::size_t i = 0; i < a.size(); ++i) {
      int ignored = 0;
      const double p = a[i], q = std::ldexp(std::frexp(b[i], &ignored), i % 3 == 0 ? -900 : 0);
      sum.add_product(p, q), counts.add_product(p, q);
      if (seed % 2 == 0)
        sum.add_product(-p, q), counts.add_product(-p, q), sum.add_product(q, q), counts.add_product(q, q);
    }
    EXPECT_EQ(sum.rounded(), counts.rounded()) << "seed " << seed;
  }
}

TEST(ExactSum, DependsNeitherOnOrderNorOnParts) {
  std::vector<double> terms = of_all_magnitudes(5000, 7);
  const double whole = sum_of(terms);
  std::mt19937_64 random(3);
  for (int turn = 0; turn < 5; ++turn) {
    std::shuffle(terms.begin(), terms.end(), random);
    ExactSum parts[7];
    for (const double t : terms) parts[random() % 7].add(t);
    ExactSum merged;
    for (const ExactSum& part : parts) merged.add(part);
    EXPECT_EQ(merged.rounded(), whole);
  }
}

TEST(ExactSum, ExpansionHoldsWhatRoundingLoses) {
  ExactSum sum;
  for (const double t : {1.0, 0x1p-60, 0x1p-120}) sum.add(t);
  const std::array<double, 3> parts = sum.expansion();
  EXPECT_EQ(parts[0], 1);
  EXPECT_EQ(parts[1], 0x1p-60);
  EXPECT_EQ(parts[2], 0x1p-120);
}

}  // namespace
}  // namespace pointsweep
