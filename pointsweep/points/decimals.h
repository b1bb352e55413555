// SPDX-License-Identifier: MIT
/// Decimal fractions that float64 holds only approximately: 0.01 * 68499257 is 684992.5700000001 and means 684992.57.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "pointsweep/points/schema.h"

namespace pointsweep {

/// Largest number of digits after the decimal point that decimals_of() tries.
inline constexpr int kMostDecimals = 9;

/// Returns the smallest number of digits, up to kMostDecimals, such that `value` is the float64 nearest to a decimal
/// fraction with that many digits after the point; nullopt if there is no such number.
std::optional<int> decimals_of(double value);

/// Finds a step of which all added values are multiples, such as 0.01 or 0.00025. LAS outputs take the step of float64
/// coordinates as their scale.
class CommonStep {
 public:
  /// Adds a finite value. Returns false if `value` is not a decimal fraction of up to kMostDecimals digits; size() then
  /// has no meaning.
  bool take(double value);
  bool empty() const { return values_ == 0; }
  /// Returns 10^-d, where d is the largest number of digits after the decimal point of a value. From 100 values on,
  /// returns the largest step of the form 1/n of which all values are multiples, if all values are below 2^53 * 10^-d.
  double size() const;

 private:
  std::uint64_t values_ = 0;
  int decimals_ = 0;         ///< largest number of digits after the decimal point of a value
  std::int64_t common_ = 1;  ///< greatest common divisor of 10^decimals_ and all values * 10^decimals_
};

/// Restores the decimal numbers of an integer field whose scale is a decimal fraction, such as 0.01. A value computed
/// as raw * scale + bias in float64 may differ in its last bits from the float64 nearest to the decimal number.
class GridDecimals {
 public:
  explicit GridDecimals(const Field& field);
  /// Returns the float64 nearest to the decimal number that has as many digits after the point as the scale or the
  /// bias, if `value` is at most 4 epsilon (|value| + |bias|) from it, a bound of the rounding errors of raw * scale +
  /// bias. Otherwise returns `value`.
  double of(double value) const;
  /// Returns whether of() may change a value.
  bool any() const { return decimals_[0] || decimals_[1]; }

 private:
  /// Number of digits after the decimal point of the scale, then of the bias if the bias has more. of() tries both
  /// numbers in this order and skips an absent number.
  std::array<std::optional<int>, 2> decimals_;
  double bias_;  ///< absolute value of the bias
};

}  // namespace pointsweep
