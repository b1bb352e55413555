// SPDX-License-Identifier: MIT
/// Decimal fractions that float64 holds only nearly: 0.01 * 68499257 is 684992.5700000001, and means 684992.57.
#pragma once

#include <array>
#include <optional>

#include "pointsweep/points/schema.h"

namespace pointsweep {

/// Digits that decimals are looked for behind the point.
inline constexpr int kMostDecimals = 9;

/// The fewest digits behind the point, up to kMostDecimals, with which `value` is the float64 nearest to a decimal
/// fraction; absent if there are none.
std::optional<int> decimals_of(double value);

/// Decimal numbers of a field whose scale and bias are decimal fractions: raw * scale + bias in float64 differs from
/// them in the last digits.
class GridDecimals {
 public:
  explicit GridDecimals(const Field& field);
  /// The float64 nearest to the decimal fraction on the grid if `value` is that but for a few units in its last place;
  /// else `value`.
  double of(double value) const;
  /// Returns whether of() may change a value.
  bool any() const { return decimals_[0] || decimals_[1]; }

 private:
  std::array<std::optional<int>, 2> decimals_;  ///< of the scale, and of both; absent without a scale
  double bias_;
};

}  // namespace pointsweep
