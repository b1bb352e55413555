// SPDX-License-Identifier: MIT
/// The properties of all values of a cloud that some formats need before the first point is written (Format::values).
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "pointsweep/formats/las_scale.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {

/// The range of values of a field, known from its type or from reading all points.
struct ValueRange {
  double lo = std::numeric_limits<double>::infinity(), hi = -std::numeric_limits<double>::infinity();
  bool whole = true;  ///< all values are integers

  /// Extends the range. NaN makes the range infinite, so that only a floating type can hold it.
  void include(double value) {
    if (std::isnan(value)) return include(unknown());
    lo = std::min(lo, value);
    hi = std::max(hi, value);
    whole = whole && std::nearbyint(value) == value;
  }
  void include(const ValueRange& other) {
    lo = std::min(lo, other.lo);
    hi = std::max(hi, other.hi);
    whole = whole && other.whole;
  }
  bool within(double least, double most) const { return lo >= least && hi <= most; }
  static ValueRange unknown() {
    return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(), false};
  }
};

/// Returns the range of all values that the type of `field`, its bits, scale and bias allow.
inline ValueRange range_of_type(const Field& field) {
  if (field.type == Type::f32 || field.type == Type::f64) return ValueRange::unknown();
  const bool is_signed =
      field.type == Type::i8 || field.type == Type::i16 || field.type == Type::i32 || field.type == Type::i64;
  const int bits = field.bit_width != 0 ? field.bit_width : static_cast<int>(8 * size_of(field.type));
  const double lo = is_signed && field.bit_width == 0 ? -std::ldexp(1.0, bits - 1) : 0;
  const double hi = lo + (std::ldexp(1.0, bits) - 1);
  ValueRange range;
  range.include(lo * field.scale + field.bias);
  range.include(hi * field.scale + field.bias);
  range.whole = std::nearbyint(field.scale) == field.scale && std::nearbyint(field.bias) == field.bias;
  return range;
}

struct KnownValues {
  std::vector<ValueRange> ranges;  ///< one for each field of the cloud
  /// The grid on which LAS stores the coordinates. Every coordinate lies on the grid, or all inputs are LAS and their
  /// coordinates are rounded to the finest scale of the inputs. Absent if no grid is known.
  std::optional<LasQuantization> grid = std::nullopt;
  bool rounds = false;       ///< the coordinates are rounded to `grid`
  bool by_decimals = false;  ///< `grid` follows from the decimals of the coordinates and does not apply to moved points
};

}  // namespace pointsweep
