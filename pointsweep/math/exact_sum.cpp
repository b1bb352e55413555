// SPDX-License-Identifier: MIT
#include "pointsweep/math/exact_sum.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

__extension__ typedef unsigned __int128 Wide;

/// |value| = mantissa * 2^exponent
struct Parts {
  std::uint64_t mantissa;
  int exponent;
};

Parts parts_of(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  const auto field = static_cast<int>(bits >> 52 & 0x7ff);
  const std::uint64_t fraction = bits & ((std::uint64_t{1} << 52) - 1);
  if (field == 0) return {fraction, -1074};
  return {fraction | std::uint64_t{1} << 52, field - 1075};
}

/// The number of terms after which carry() is due. Digits of 32 bits stay below 2^63 while this number of terms is
/// added.
constexpr std::uint32_t kMostPending = 1u << 29;

}  // namespace

void ExactSum::add(double term) {
  if (!std::isfinite(term)) return add_unusual(term);
  const Parts p = parts_of(term);
  if (p.mantissa != 0) add_scaled(std::signbit(term), 0, p.mantissa, p.exponent);
}

void ExactSum::add_product(double a, double b) {
  if (!std::isfinite(a) || !std::isfinite(b)) return add_unusual(a * b);
  const Parts p = parts_of(a), q = parts_of(b);
  const Wide product = static_cast<Wide>(p.mantissa) * q.mantissa;
  if (product != 0)
    add_scaled(std::signbit(a) != std::signbit(b), static_cast<std::uint64_t>(product >> 64),
               static_cast<std::uint64_t>(product), p.exponent + q.exponent);
}

/// Adds ± (high * 2^64 + low) * 2^exponent; `high` is below 2^42.
void ExactSum::add_scaled(bool negative, std::uint64_t high, std::uint64_t low, int exponent) {
  const int place = exponent - kLeastExponent;
  auto digit = static_cast<std::size_t>(place / kDigitBits);
  const int shift = place % kDigitBits;
  const auto add_digits = [&](Wide value, std::size_t at) {
    for (; value != 0; value >>= kDigitBits, ++at) {
      const auto part = static_cast<std::int64_t>(static_cast<std::uint32_t>(value));
      digits_[at] += negative ? -part : part;
    }
  };
  add_digits(static_cast<Wide>(low) << shift, digit);
  if (high != 0) add_digits(static_cast<Wide>(high) << shift, digit + 2);
  if (++pending_ >= kMostPending) carry();
}

void ExactSum::add_unusual(double term) {
  nan_ = nan_ || std::isnan(term);
  positive_infinity_ = positive_infinity_ || term == std::numeric_limits<double>::infinity();
  negative_infinity_ = negative_infinity_ || term == -std::numeric_limits<double>::infinity();
}

void ExactSum::add(const ExactSum& other) {
  ExactSum terms = other;
  terms.carry();
  carry();
  for (std::size_t i = 0; i < kDigits; ++i) digits_[i] += terms.digits_[i];
  carry();
  nan_ = nan_ || other.nan_;
  positive_infinity_ = positive_infinity_ || other.positive_infinity_;
  negative_infinity_ = negative_infinity_ || other.negative_infinity_;
}

/// Brings all digits but the last into [0, 2^32); the last digit has the sign of the sum.
void ExactSum::carry() {
  std::int64_t above = 0;
  for (std::size_t i = 0; i + 1 < kDigits; ++i) {
    const std::int64_t value = digits_[i] + above;
    above = value >> kDigitBits;  // rounds down, so that the remainder is not negative
    digits_[i] = value - above * (std::int64_t{1} << kDigitBits);
  }
  digits_[kDigits - 1] += above;
  pending_ = 0;
}

ExactSum::State ExactSum::state() const {
  ExactSum sum = *this;
  sum.carry();
  std::size_t first = 0, end = kDigits;
  while (end > 0 && sum.digits_[end - 1] == 0) --end;
  while (first < end && sum.digits_[first] == 0) ++first;
  return {static_cast<std::uint32_t>(first),
          {&sum.digits_[first], &sum.digits_[first] + (end - first)},
          nan_,
          positive_infinity_,
          negative_infinity_};
}

void ExactSum::add(const State& state) {
  if (state.digits.size() > kDigits || state.first > kDigits - state.digits.size())
    fail("A sum of doubles has {} digits at most, not {} from the digit {} on.", kDigits, state.digits.size(),
         state.first);
  ExactSum sum;
  std::ranges::copy(state.digits, &sum.digits_[state.first]);
  sum.nan_ = state.nan;
  sum.positive_infinity_ = state.positive_infinity;
  sum.negative_infinity_ = state.negative_infinity;
  add(sum);
}

double ExactSum::rounded() const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (nan_ || (positive_infinity_ && negative_infinity_)) return std::numeric_limits<double>::quiet_NaN();
  if (positive_infinity_) return kInfinity;
  if (negative_infinity_) return -kInfinity;
  ExactSum sum = *this;
  sum.carry();
  const bool negative = sum.digits_[kDigits - 1] < 0;
  if (negative) {
    for (std::int64_t& digit : sum.digits_) digit = -digit;
    sum.carry();
  }
  std::size_t top = kDigits;
  while (top > 0 && sum.digits_[top - 1] == 0) --top;
  if (top == 0) return 0;
  // `leading` gets the upper three digits; `rest` is true if any bit below them is set.
  Wide leading = 0;
  std::size_t lowest = top > 3 ? top - 3 : 0;
  for (std::size_t i = top; i > lowest; --i) leading = leading << kDigitBits | static_cast<Wide>(sum.digits_[i - 1]);
  bool rest = false;
  for (std::size_t i = 0; i < lowest; ++i) rest = rest || sum.digits_[i] != 0;
  const int exponent = static_cast<int>(lowest) * kDigitBits + kLeastExponent;
  const auto upper = static_cast<std::uint64_t>(leading >> 64);
  const int bits =
      upper != 0 ? 128 - std::countl_zero(upper) : 64 - std::countl_zero(static_cast<std::uint64_t>(leading));
  // A double keeps 53 bits, or the bits from 2^-1074 on.
  int dropped = bits - 53;
  if (exponent + dropped < -1074) dropped = -1074 - exponent;
  if (dropped > bits + 1) return negative ? -0.0 : 0.0;
  std::uint64_t mantissa;
  if (dropped <= 0) {
    mantissa = static_cast<std::uint64_t>(leading) << -dropped;
  } else {
    mantissa = static_cast<std::uint64_t>(leading >> dropped);
    const Wide half = Wide{1} << (dropped - 1), below = leading & ((Wide{1} << dropped) - 1);
    if (below > half || (below == half && (rest || (mantissa & 1) != 0))) ++mantissa;
  }
  const double value = std::ldexp(static_cast<double>(mantissa), exponent + dropped);
  return negative ? -value : value;
}

int ExactSum::sign() const {
  ExactSum sum = *this;
  sum.carry();
  if (sum.digits_[kDigits - 1] < 0) return -1;
  return std::ranges::any_of(sum.digits_, [](std::int64_t digit) { return digit != 0; }) ? 1 : 0;
}

std::array<double, 3> ExactSum::expansion() const {
  std::array<double, 3> parts{};
  ExactSum rest = *this;
  for (double& part : parts) {
    part = rest.rounded();
    if (!std::isfinite(part)) break;
    rest.add(-part);
  }
  return parts;
}

double n_squared_variance(const ExactSum& sum, const ExactSum& squares, double n) {
  ExactSum difference;
  for (const double part : squares.expansion()) difference.add_product(n, part);
  const std::array<double, 3> parts = sum.expansion();
  for (const double a : parts)
    for (const double b : parts) difference.add_product(-a, b);
  return std::max(0.0, difference.rounded());
}

}  // namespace pointsweep
