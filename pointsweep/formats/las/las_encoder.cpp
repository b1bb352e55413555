// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las/las_encoder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/formats/las/las_point_formats.h"
#include "pointsweep/formats/las_scale.h"

namespace pointsweep {
namespace {

constexpr std::size_t kRowsAtOnce = 256;
/// Byte 14 of a point that is return 1 of 1, in point formats 0 to 5 and 6 to 10.
constexpr std::byte kOnlyLegacyReturn{0x09}, kOnlyReturn{0x11};

/// Returns whether a coordinate is farther from the grid than rounding in float64 explains.
bool is_beside_grid(double value, double scale, double offset) {
  const double steps = (value - offset) / scale;
  return std::abs(steps - std::nearbyint(steps)) > 1e-3 && !is_on_las_grid(value, scale, offset);
}

}  // namespace

LasEncoder::LasEncoder(const LasLayout& layout, std::string path)
    : conversion_(layout.from, layout.to),
      positions_{layout.x, layout.y, layout.z},
      scale_(layout.header.scale),
      offset_(layout.header.offset),
      stride_in_(layout.from.stride),
      stride_out_(layout.to.stride),
      fitting_scale_(layout.fitting_scale),
      positions_change_(layout.positions_change),
      returns_missing_(layout.returns_missing),
      notes_rounding_(layout.points_moved && layout.keeps_scale),
      only_return_(layout.header.point_format >= 6 ? kOnlyReturn : kOnlyLegacyReturn),
      path_(std::move(path)) {}

void LasEncoder::run(std::uint64_t row, const std::byte* from, std::byte* to, std::size_t count) const {
  if (positions_change_) check_positions(row, from, count);
  conversion_.run(from, to, count);
  if (!returns_missing_) return;
  for (std::size_t i = 0; i < count; ++i) to[i * stride_out_ + kLasReturnByte] = only_return_;
}

void LasEncoder::check_positions(std::uint64_t row, const std::byte* records, std::size_t count) const {
  std::array<std::array<double, kRowsAtOnce>, 3> xyz;
  for (std::size_t first = 0; first < count; first += kRowsAtOnce) {
    const std::size_t n = std::min(kRowsAtOnce, count - first);
    decode_positions(positions_, records + first * stride_in_, stride_in_, n, xyz[0].data(), xyz[1].data(),
                     xyz[2].data());
    for (std::size_t i = 0; i < n; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        const double value = xyz[static_cast<std::size_t>(axis)][i];
        if (!las_grid_reaches(value, scale_[axis], offset_[axis])) refuse(axis, row + first + i, value);
        if (!notes_rounding_ || rounds_) continue;
        if (is_beside_grid(value, scale_[axis], offset_[axis])) rounds_ = true;
      }
    }
  }
}

void LasEncoder::refuse(int axis, std::uint64_t row, double value) const {
  if (!std::isfinite(value))
    fail("{}: {} of row {} is {}, which LAS cannot hold; write PLY, or remove such points.", path_, "xyz"[axis], row,
         value);
  const std::string remedy = fitting_scale_ && (*fitting_scale_)[axis] > scale_[axis]
                                 ? fmt::format(" a scale of {} would reach all points;", (*fitting_scale_)[axis])
                                 : "";
  fail(
      "{}: {} of row {} is {}, too far from the offset {} for the scale {} of this LAS file;{} write PLY, or leave out "
      "points that are far from the others.",
      path_, "xyz"[axis], row, value, offset_[axis], scale_[axis], remedy);
}

std::string LasEncoder::rounding() const {
  if (!rounds_) return "";
  const double coarsest = std::max({scale_.x, scale_.y, scale_.z});
  const bool alike = scale_.x == scale_.y && scale_.y == scale_.z;
  const std::string steps =
      alike ? fmt::format("{}", scale_.x) : fmt::format("{} in x, {} in y and {} in z", scale_.x, scale_.y, scale_.z);
  return fmt::format("{}: moved coordinates are rounded to steps of {}, by at most {}.", path_, steps, coarsest / 2);
}

}  // namespace pointsweep
