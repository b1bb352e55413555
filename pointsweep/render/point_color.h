// SPDX-License-Identifier: MIT
/// The colour of a point, from what its file says of it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/points/schema.h"
#include "pointsweep/render/canvas.h"

namespace pointsweep {

class PointColor {
 public:
  /// `what`: rgb (the file's colours), normal (its components as colours), height (the coordinate that points up),
  /// curvature (RMS curvature, or what of its kind there is), plain (grey), or the name of an attribute; empty chooses
  /// the first of rgb, plain with normals, height. `name` is how the caller's option is called. Throws UsageError that
  /// lists what there is.
  PointColor(const Schema& schema, std::string_view what, int up, std::string_view name = "--color");

  /// "rms_curvature", "rgb", ...: what it became.
  const std::string& name() const { return name_; }
  /// True where a number of each point decides; its range has to be set.
  bool is_number() const { return kind_ == Kind::number; }
  double number(const std::byte* record) const { return value_of(fields_[0], record); }
  /// lo is the dark end of viridis, hi the yellow one.
  void set_range(double lo, double hi) { lo_ = lo, hi_ = hi; }
  double lo() const { return lo_; }
  double hi() const { return hi_; }

  /// Takes note of the largest component of a colour, which tells whether it is out of 1, 255 or 65,535.
  void look_at(const std::byte* record);
  /// Whether light and shade go on top.
  bool is_shaded() const { return kind_ != Kind::normal; }

  Rgb operator()(const std::byte* record) const;

 private:
  enum class Kind { plain, rgb, normal, number };
  bool take(const Schema& schema, Kind kind, const std::array<const char*, 3>& names);
  bool take_number(const Schema& schema, std::string_view name);
  double scale() const;

  Kind kind_ = Kind::plain;
  std::string name_;
  std::array<Field, 3> fields_;
  double lo_ = 0, hi_ = 1;
  double most_ = 0;
};

/// The 5 % and 95 % quantiles of the finite ones of `values`, so that outliers do not use up the colours; (0, 1) if
/// there is none.
std::pair<double, double> robust_range(std::vector<double> values);

}  // namespace pointsweep
