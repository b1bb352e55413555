// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las_scale.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "pointsweep/points/schema.h"
#include "pointsweep/reader.h"

namespace pointsweep {
namespace {

constexpr double kUsableSteps = 2147483646;  // one less than kMostLasSteps, since rounding may add one
constexpr int kLeast = -300, kMost = 300;

/// Returns 10^exponent, correctly rounded, which std::pow does not guarantee.
double power_of_ten(int exponent) {
  std::array<char, 8> text{'1', 'e'};
  const char* end = std::to_chars(text.data() + 2, text.data() + text.size(), exponent).ptr;
  double value = 0;
  std::from_chars(text.data(), end, value);
  return value;
}

/// Returns the exponent of the largest power of ten that is at most `size`.
int exponent_of(double size) {
  int exponent = kLeast;
  while (exponent < kMost && power_of_ten(exponent + 1) <= size) ++exponent;
  return exponent;
}

/// Returns the multiple of a power of ten nearest to `value`; the power is the largest that is at most an eighth of
/// `size`.
double round_number(double value, double size) {
  const int exponent = exponent_of(size / 8);
  return exponent >= 0 ? std::nearbyint(value / power_of_ten(exponent)) * power_of_ten(exponent)
                       : std::nearbyint(value * power_of_ten(-exponent)) / power_of_ten(-exponent);
}

/// Chooses scale and offset for coordinates in [lo, hi]. `useful`: the smallest useful step, so that a flat axis does
/// not get an absurdly fine scale.
void quantize_axis(double lo, double hi, double useful, double& scale, double& offset) {
  const double largest = std::max(std::abs(lo), std::abs(hi));
  const double half = 0.5 * hi - 0.5 * lo;
  const double finest = std::max(largest * std::numeric_limits<double>::epsilon(), useful);
  offset = (half > finest ? round_number(0.5 * lo + 0.5 * hi, half) : lo) + 0.0;  // -0 becomes 0
  const double reach = std::max(hi - offset, offset - lo);
  int exponent = kLeast;
  while (exponent < kMost && (power_of_ten(exponent) < finest || reach / power_of_ten(exponent) > kUsableSteps)) {
    ++exponent;
  }
  scale = power_of_ten(exponent);
}

/// Returns `steps` times `scale`. For scales like 0.001 the result is correctly rounded, so that the number in the
/// header has few digits.
double length_of(double steps, double scale) {
  const double inverse = std::nearbyint(1 / scale);
  return inverse > 0 && 1 / inverse == scale ? steps / inverse : steps * scale;
}

bool reaches(double lo, double hi, double scale, double offset) {
  return las_grid_reaches(lo, scale, offset) && las_grid_reaches(hi, scale, offset);
}

void take_finer_grid(LasQuantization& grid, const LasQuantization& other) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!(other.scale[axis] < grid.scale[axis])) continue;
    grid.scale[axis] = other.scale[axis];
    grid.offset[axis] = other.offset[axis];
  }
}

const char* name_of_time(const LasOrigin& origin) {
  return origin.standard_time ? "adjusted standard GPS time" : "seconds of the GPS week";
}

}  // namespace

LasQuantization grid_of(const PositionFields& fields) {
  const auto& [x, y, z] = fields;
  return {{x.scale, y.scale, z.scale}, {x.bias, y.bias, z.bias}};
}

bool las_grid_reaches(double value, double scale, double offset) {
  return std::abs((value - offset) / scale) <= kMostLasSteps;
}

bool is_on_las_grid(double value, double scale, double offset) {
  const double steps = std::nearbyint((value - offset) / scale);
  const double tolerance = 4 * std::numeric_limits<double>::epsilon() * (std::abs(value) + std::abs(offset));
  return std::abs(steps) <= kMostLasSteps && std::abs(steps * scale + offset - value) <= tolerance;
}

LasQuantization las_quantization(const Box& bounds) {
  LasQuantization q;
  if (bounds.empty()) return q;
  double half = 0;
  for (int axis = 0; axis < 3; ++axis) half = std::max(half, 0.5 * bounds.hi[axis] - 0.5 * bounds.lo[axis]);
  const double useful = half > 0 ? half * 1e-12 : 1e-9;
  for (int axis = 0; axis < 3; ++axis) {
    quantize_axis(bounds.lo[axis], bounds.hi[axis], useful, q.scale[axis], q.offset[axis]);
  }
  return q;
}

LasQuantization las_grid_within(const LasQuantization& grid, const Box& bounds) {
  LasQuantization q = las_grid_for_moved(grid, bounds);
  for (int axis = 0; axis < 3 && !bounds.empty(); ++axis) {
    if (reaches(bounds.lo[axis], bounds.hi[axis], q.scale[axis], q.offset[axis])) continue;
    const LasQuantization coarse = las_quantization(bounds);
    q.scale[axis] = coarse.scale[axis];
    q.offset[axis] = coarse.offset[axis];
  }
  return q;
}

LasQuantization las_grid_for_moved(const LasQuantization& grid, const Box& bounds) {
  LasQuantization q = grid;
  if (bounds.empty()) return q;
  for (int axis = 0; axis < 3; ++axis) {
    const double lo = bounds.lo[axis], hi = bounds.hi[axis], scale = grid.scale[axis];
    if (reaches(lo, hi, scale, grid.offset[axis])) continue;
    const double steps = (0.5 * lo + 0.5 * hi - grid.offset[axis]) / scale;
    const double offset = grid.offset[axis] + length_of(std::nearbyint(steps / kRoundSteps) * kRoundSteps, scale);
    if (reaches(lo, hi, scale, offset)) q.offset[axis] = offset;
  }
  return q;
}

LasQuantization las_grid_in_the_middle(const LasQuantization& grid, const Box& bounds) {
  LasQuantization q = grid;
  for (int axis = 0; axis < 3 && !bounds.empty(); ++axis) {
    const double steps = (0.5 * bounds.lo[axis] + 0.5 * bounds.hi[axis]) / grid.scale[axis];
    q.offset[axis] = length_of(std::nearbyint(steps / kRoundSteps) * kRoundSteps, grid.scale[axis]) + 0.0;
  }
  return q;
}

Vec3 las_scale_from(Vec3 offset, const Box& bounds) {
  Vec3 scale = las_quantization(bounds).scale;
  for (int axis = 0; axis < 3; ++axis) {
    int exponent = exponent_of(scale[axis]);
    while (exponent < kMost && !reaches(bounds.lo[axis], bounds.hi[axis], scale[axis], offset[axis]))
      scale[axis] = power_of_ten(++exponent);
  }
  return scale;
}

std::optional<LasOrigin> common_las_origin(const std::vector<std::shared_ptr<Reader>>& readers,
                                           std::vector<std::string>& warnings) {
  std::optional<LasOrigin> common;
  const FileInfo* timed = nullptr;
  bool warned = false;
  for (const auto& reader : readers) {
    const FileInfo& info = reader->info();
    if (!info.las) continue;
    if (!common) common = LasOrigin{.grid = info.las->grid, .overlap_is_class_12 = true};
    take_finer_grid(common->grid, info.las->grid);
    common->overlap_is_class_12 = common->overlap_is_class_12 && info.las->overlap_is_class_12;
    if (!info.las->has_time) continue;
    if (timed == nullptr) {
      timed = &info;
      common->has_time = true;
      common->standard_time = info.las->standard_time;
    } else if (!warned && info.las->standard_time != common->standard_time) {
      warned = true;
      warnings.push_back(fmt::format("GPS times of {} are {}, those of {} {}; they are merged unchanged.",
                                     timed->path.string(), name_of_time(*timed->las), info.path.string(),
                                     name_of_time(*info.las)));
    }
  }
  return common;
}

}  // namespace pointsweep
