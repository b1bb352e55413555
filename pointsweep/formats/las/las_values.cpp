// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>

#include "pointsweep/formats/format.h"
#include "pointsweep/formats/las/las_format.h"
#include "pointsweep/formats/las/las_layout.h"
#include "pointsweep/formats/las/las_point_formats.h"
#include "pointsweep/formats/las_scale.h"
#include "pointsweep/points/decimals.h"

namespace pointsweep {
namespace {

constexpr std::size_t kBlockRows = 8192;

bool is_las(const std::shared_ptr<Reader>& reader) { return extras_as<LasExtras>(reader->info().extras) != nullptr; }

/// Reads points to find the ranges of some fields and the grid of the coordinates. Ends early if no ranges are wanted
/// and the coordinates lie on no grid.
class Look {
 public:
  enum class For : std::uint8_t { nothing, grid, decimals };
  Look(InputCloud& cloud, KnownValues& values, std::vector<std::size_t> fields, For coordinates)
      : cloud_(cloud), values_(values), fields_(std::move(fields)), coordinates_(coordinates) {
    for (const std::size_t field : fields_) values_.ranges[field] = {};
  }

  void run(const std::function<void(std::uint64_t)>& progress) {
    const std::size_t stride = cloud_.schema().stride;
    std::vector<std::byte> records(kBlockRows * stride);
    for (std::uint64_t row = 0; row < cloud_.count() && (coordinates_ != For::nothing || !fields_.empty());) {
      const std::size_t rows = cloud_.read(row, records);
      if (rows == 0) break;
      for (std::size_t i = 0; i < rows; ++i) take_values(records.data() + i * stride);
      if (coordinates_ != For::nothing && !take_coordinates(records.data(), rows)) coordinates_ = For::nothing;
      row += rows;
      if (progress) progress(row);
    }
  }

  /// Returns the grid on which all coordinates lie; nothing if there is none. Must be called after run().
  std::optional<LasQuantization> grid() const {
    if (coordinates_ == For::grid) return cloud_.las()->grid;
    if (coordinates_ == For::nothing || common_.empty()) return std::nullopt;
    const double scale = common_.size();
    return LasQuantization{{scale, scale, scale}, {0, 0, 0}};
  }

 private:
  void take_values(const std::byte* record) {
    for (const std::size_t f : fields_) values_.ranges[f].include(value_of(cloud_.schema().fields[f], record));
  }

  /// Returns false if the coordinates read so far lie on no common grid. Coordinates that are not finite are ignored.
  bool take_coordinates(const std::byte* records, std::size_t rows) {
    for (auto& axis : xyz_) axis.resize(kBlockRows);
    decode_positions(positions_, records, cloud_.schema().stride, rows, xyz_[0].data(), xyz_[1].data(), xyz_[2].data());
    for (int axis = 0; axis < 3; ++axis)
      for (std::size_t i = 0; i < rows; ++i) {
        const double value = xyz_[static_cast<std::size_t>(axis)][i];
        if (std::isfinite(value) && !take_coordinate(axis, value)) return false;
      }
    return true;
  }

  bool take_coordinate(int axis, double value) {
    if (coordinates_ == For::decimals) return common_.take(value);
    const LasQuantization& grid = cloud_.las()->grid;
    return is_on_las_grid(value, grid.scale[axis], grid.offset[axis]);
  }

  InputCloud& cloud_;
  KnownValues& values_;
  std::vector<std::size_t> fields_;
  For coordinates_;
  CommonStep common_;  ///< common step of the coordinates read so far, for For::decimals
  PositionFields positions_ = position_fields(cloud_.schema(), "the input");
  std::array<std::vector<double>, 3> xyz_;
};

/// Returns whether all coordinates are unscaled float64, as from text files and arrays.
bool are_double(const PositionFields& p) {
  const auto is_double = [](const Field& f) { return f.type == Type::f64 && f.is_plain(); };
  return is_double(p.x) && is_double(p.y) && is_double(p.z);
}

/// The facts about all points that an output needs to know before its first record.
struct Sought {
  std::vector<std::size_t> fields;  ///< fields whose values decide which point format holds the field
  Look::For coordinates = Look::For::nothing;
};

bool all_are_las(const InputCloud& cloud) { return std::ranges::all_of(cloud.readers(), is_las); }

Sought sought_in(const InputCloud& cloud, const FileLayout& layout) {
  Sought sought;
  const bool from_las = cloud.las() != nullptr;
  const PositionFields positions = position_fields(cloud.schema(), "the input");
  const std::shared_ptr<const FormatExtras> extras = cloud.extras();
  const auto* const first = extras_as<LasExtras>(extras);
  if (first == nullptr || !las_keeps_records(*first->parts(), cloud.schema(), layout))
    sought.fields = undecided_las_fields(cloud.schema(), cloud.ranges(), las_choice(layout, from_las));
  if (las_keeps_scale(positions)) return sought;
  if (!from_las && are_double(positions)) sought.coordinates = Look::For::decimals;
  if (from_las && !all_are_las(cloud)) sought.coordinates = Look::For::grid;
  return sought;
}

}  // namespace

bool las_values_need_points(const InputCloud& cloud, const FileLayout& layout) {
  const Sought sought = sought_in(cloud, layout);
  return !sought.fields.empty() || sought.coordinates != Look::For::nothing;
}

KnownValues las_values(InputCloud& cloud, const FileLayout& layout,
                       const std::function<void(std::uint64_t)>& progress) {
  KnownValues values{cloud.ranges()};
  const Sought sought = sought_in(cloud, layout);
  const PositionFields positions = position_fields(cloud.schema(), "the input");
  const bool real = !las_keeps_scale(positions);
  values.rounds = real && all_are_las(cloud);
  values.by_decimals = sought.coordinates == Look::For::decimals;
  Look look(cloud, values, sought.fields, sought.coordinates);
  look.run(progress);
  values.grid = !real ? grid_of(positions) : values.rounds ? cloud.las()->grid : look.grid();
  return values;
}

}  // namespace pointsweep
