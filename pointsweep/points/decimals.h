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

/// Returns the smallest number of digits after the decimal point, up to kMostDecimals, with which `value` is the
/// float64 nearest to a decimal fraction; nullopt if there is no such number.
std::optional<int> decimals_of(double value);

/// The largest step of which all values of a cloud are multiples: 0.01, or 0.00025, which text represents with five
/// digits.
class CommonStep {
 public:
  /// Adds a finite value. Returns false if `value` is not a decimal fraction of up to kMostDecimals digits.
  bool take(double value);
  bool empty() const { return values_ == 0; }
  /// Returns a step of at most 1: with fewer than 100 values, a power of ten that follows from their digits; otherwise,
  /// the largest divisor of 1 of which all values are multiples.
  double size() const;

 private:
  std::uint64_t values_ = 0;
  int decimals_ = 0;         ///< largest number of digits after the decimal point of a value
  std::int64_t common_ = 1;  ///< greatest common divisor of 10^decimals_ and of all values times 10^decimals_
};

/// Restores the decimal numbers of a field whose scale and bias are decimal fractions: raw * scale + bias, computed in
/// float64, may differ from the decimal number in the last digits.
class GridDecimals {
 public:
  explicit GridDecimals(const Field& field);
  /// Returns the float64 nearest to a decimal number with as many digits as the scale or the bias, if `value` differs
  /// from it by at most 4 epsilon (|value| + |bias|), the rounding of raw * scale + bias; else returns `value`.
  double of(double value) const;
  /// Returns whether of() may change a value.
  bool any() const { return decimals_[0] || decimals_[1]; }

 private:
  /// Digits after the decimal point: of the scale, and of the bias if it has more; absent values are not tried.
  std::array<std::optional<int>, 2> decimals_;
  double bias_;
};

}  // namespace pointsweep
