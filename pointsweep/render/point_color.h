// SPDX-License-Identifier: MIT
/// The colour of a point, from its attributes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/points/schema.h"
#include "pointsweep/render/canvas.h"
#include "pointsweep/render/view.h"

namespace pointsweep {

/// Chooses the colours of points. The calls come in this order: the constructor with the schema, look_at() for every
/// record, settle(), which makes the choice, then operator() for the colour of each point.
class PointColor {
 public:
  /// `what`: rgb (the file's colours), normal (its components as colours), height (the coordinate that points up),
  /// curvature (RMS curvature, or another curvature that the file has), classification (the standard colours of LAS),
  /// plain (grey), or the name of an attribute. If `what` is empty, the choice is rgb if colours differ between points,
  /// else plain if the file has normals and the cloud is not flat, else height. `option`: name of the caller's option,
  /// for messages. Throws UsageError that lists the fields of the schema if `what` is none of these, or if the schema
  /// lacks its fields.
  PointColor(const Schema& schema, std::string_view what, std::string_view option = "--color");

  /// Extends the ranges of red, green and blue, if they are the colouring, or the set of classes, if that is the
  /// colouring, by those of the record.
  void look_at(const std::byte* record);

  /// A sample of the cloud: record i of `stride` bytes belongs to position i.
  struct Sample {
    const std::vector<Vec3>& positions;
    const std::vector<std::byte>& records;
    std::size_t stride;
  };
  /// Chooses the colouring, and sets the range of its numbers, if it has any, by robust_range() of the sample. `flat`:
  /// is_flat() of the cloud.
  void settle(const Sample& sample, Up up, bool flat);

  /// Returns the name of the colouring that is used: "rms_curvature", "rgb", ...
  const std::string& name() const { return name_; }
  /// Returns whether the colours show a number of each point.
  bool is_number() const { return kind_ == Kind::number || kind_ == Kind::height; }
  bool is_class() const { return kind_ == Kind::classes; }
  double number(const std::byte* record, Vec3 position) const {
    return kind_ == Kind::height ? up_.height(position) : value_of(fields_[0], record);
  }
  /// Returns the number at the dark end of the colour map viridis; hi() returns the number at the yellow end.
  double lo() const { return lo_; }
  double hi() const { return hi_; }
  /// Returns the classes that occur, ascending; empty unless is_class().
  std::vector<std::uint8_t> classes() const;
  /// Returns a sentence for the user if rgb was possible but all points have one colour; else an empty text.
  const std::string& remark() const { return remark_; }
  /// Returns whether light and shade are added to the colours.
  bool is_shaded() const { return kind_ != Kind::normal; }

  Rgb operator()(const std::byte* record, Vec3 position) const;

 private:
  enum class Kind { plain, rgb, normal, number, height, classes };
  struct Channel {
    double least = std::numeric_limits<double>::infinity(), most = -least;
  };
  /// Takes the fields with these names, at most three, for a kind of colours. Returns false if one is missing.
  bool take(Kind kind, std::initializer_list<const char*> names);
  bool take_number(std::string_view name);
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

/// Returns the 5 % and 95 % quantiles of the finite `values`, so that outliers do not take up the range of colours;
/// (0, 1) if no value is finite.
std::pair<double, double> robust_range(std::vector<double> values);

}  // namespace pointsweep
