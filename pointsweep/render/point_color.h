// SPDX-License-Identifier: MIT
/// The colour of a point, from its attributes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/points/schema.h"
#include "pointsweep/render/canvas.h"
#include "pointsweep/render/view.h"

namespace pointsweep {

/// Used in three phases: constructed from the schema; shown every record (look_at); settled. Then it gives colours.
class PointColor {
 public:
  /// `what`: rgb (the file's colours), normal (its components as colours), height (the coordinate that points up),
  /// curvature (RMS curvature, or what of its kind there is), classification (the standard colours of LAS), plain
  /// (grey), or the name of an attribute. Empty chooses the first that applies: rgb if it is not the same for all
  /// points, plain where there are normals and the cloud is not flat, height. `option` is how the caller's
  /// option is called. Throws UsageError that lists what there is.
  PointColor(const Schema& schema, std::string_view what, std::string_view option = "--color");

  /// Takes note of the values of colours and classes.
  void look_at(const std::byte* record);

  /// A sample of the cloud: record i of `stride` bytes belongs to position i.
  struct Sample {
    const std::vector<Vec3>& positions;
    const std::vector<std::byte>& records;
    std::size_t stride;
  };
  /// Makes the choice, and sets the range of numbers from the sample (robust_range).
  void settle(const Sample& sample, Up up, bool flat);

  /// Returns the name of the colouring that is used: "rms_curvature", "rgb", ...
  const std::string& name() const { return name_; }
  /// True where a number of each point decides.
  bool is_number() const { return kind_ == Kind::number || kind_ == Kind::height; }
  bool is_class() const { return kind_ == Kind::classes; }
  double number(const std::byte* record, Vec3 position) const {
    return kind_ == Kind::height ? up_.height(position) : value_of(fields_[0], record);
  }
  /// lo is the dark end of viridis, hi the yellow one.
  double lo() const { return lo_; }
  double hi() const { return hi_; }
  /// The classes that occur, ascending.
  std::vector<std::uint8_t> classes() const;
  /// Returns why the colours of the file are not used; empty if it has none or they are used.
  const std::string& remark() const { return remark_; }
  /// Returns whether light and shade are added to the colours.
  bool is_shaded() const { return kind_ != Kind::normal; }

  Rgb operator()(const std::byte* record, Vec3 position) const;

 private:
  enum class Kind { plain, rgb, normal, number, height, classes };
  struct Channel {
    double least = std::numeric_limits<double>::infinity(), most = -least;
  };
  bool take(const Schema& schema, Kind kind, const std::array<const char*, 3>& names);
  bool take_number(const Schema& schema, std::string_view name);
  bool take_classes(const Schema& schema);
  void choose_without_colors(bool flat);
  bool colors_vary() const;
  double scale() const;
  std::uint8_t class_of(const std::byte* record) const;

  Schema schema_;
  Kind kind_ = Kind::plain;
  bool chosen_by_user_ = true;
  std::string name_, remark_;
  std::array<Field, 3> fields_;
  std::array<Channel, 3> channels_;
  std::array<bool, 256> seen_{};
  Up up_;
  double lo_ = 0, hi_ = 1;
};

/// Returns the 5 % and 95 % quantiles of the finite ones of `values`, so that outliers do not take up the range of
/// colours; (0, 1) if there are none.
std::pair<double, double> robust_range(std::vector<double> values);

}  // namespace pointsweep
