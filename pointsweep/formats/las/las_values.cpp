// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las/las_values.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "pointsweep/formats/las/las_fields.h"
#include "pointsweep/formats/las/las_layout.h"
#include "pointsweep/formats/las_origin.h"

namespace pointsweep {
namespace {

constexpr std::size_t kBlockRows = 8192;

bool is_las(const std::unique_ptr<Reader>& reader) {
  return dynamic_cast<const LasExtras*>(reader->info().extras.get()) != nullptr;
}

LasQuantization grid_of(const PositionFields& p) {
  return {{p.x.scale, p.y.scale, p.z.scale}, {p.x.bias, p.y.bias, p.z.bias}};
}

/// Reads all points; what it looks for is given to the constructor.
class Look {
 public:
  Look(InputCloud& cloud, KnownValues& values, std::vector<std::size_t> fields, bool grid)
      : cloud_(cloud), values_(values), fields_(std::move(fields)), grid_(grid) {
    for (const std::size_t field : fields_) values_.ranges[field] = {};
  }

  void run(const std::function<void(std::uint64_t)>& progress) {
    const std::size_t stride = cloud_.schema().stride;
    std::vector<std::byte> records(kBlockRows * stride);
    for (std::uint64_t row = 0; row < cloud_.count();) {
      const std::size_t rows = cloud_.read(row, records);
      if (rows == 0) break;
      for (std::size_t i = 0; i < rows; ++i) take_values(records.data() + i * stride);
      if (grid_) grid_ = are_on_grid(records.data(), rows);
      row += rows;
      if (progress) progress(row);
    }
  }
  bool all_on_grid() const { return grid_; }

 private:
  void take_values(const std::byte* record) {
    for (const std::size_t f : fields_) values_.ranges[f].include(value_of(cloud_.schema().fields[f], record));
  }

  /// Points that are not finite do not count.
  bool are_on_grid(const std::byte* records, std::size_t rows) {
    for (auto& axis : xyz_) axis.resize(kBlockRows);
    decode_positions(positions_, records, cloud_.schema().stride, rows, xyz_[0].data(), xyz_[1].data(), xyz_[2].data());
    const LasQuantization& grid = cloud_.las()->grid;
    for (int axis = 0; axis < 3; ++axis) {
      const std::vector<double>& values = xyz_[static_cast<std::size_t>(axis)];
      for (std::size_t i = 0; i < rows; ++i) {
        if (std::isfinite(values[i]) && !is_on_las_grid(values[i], grid.scale[axis], grid.offset[axis])) return false;
      }
    }
    return true;
  }

  InputCloud& cloud_;
  KnownValues& values_;
  std::vector<std::size_t> fields_;
  bool grid_;
  PositionFields positions_ = position_fields(cloud_.schema(), "the input");
  std::array<std::vector<double>, 3> xyz_;
};

}  // namespace

KnownValues las_values(InputCloud& cloud, const std::function<void(std::uint64_t)>& progress) {
  KnownValues values{cloud.ranges()};
  const bool from_las = cloud.las() != nullptr;
  const bool real = !las_keeps_scale(position_fields(cloud.schema(), "the input"));
  values.rounds = real && std::all_of(cloud.readers().begin(), cloud.readers().end(), is_las);
  const bool look_at_grid = real && from_las && !values.rounds;
  std::vector<std::size_t> fields;
  const auto first = dynamic_cast<const LasExtras*>(cloud.extras().get());
  if (first == nullptr || !las_begins_with_records_of(*first, cloud.schema()))
    fields = undecided_las_fields(cloud.schema(), values.ranges, from_las);
  Look look(cloud, values, fields, look_at_grid);
  if (look_at_grid || !fields.empty()) look.run(progress);
  if (!real)
    values.grid = grid_of(position_fields(cloud.schema(), "the input"));
  else if (values.rounds || (look_at_grid && look.all_on_grid()))
    values.grid = cloud.las()->grid;
  return values;
}

}  // namespace pointsweep
