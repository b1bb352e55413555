// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "pointsweep/order/survey.h"

namespace pointsweep {
namespace {

constexpr std::size_t kTooFew = 256, kEnough = 16384;  ///< points
constexpr std::uint64_t kMostCells = 1u << 20;  ///< along one axis: three numbers below it fit one 64-bit code

/// The box of the middle 98 % of each coordinate.
Box quantile_box(std::span<const Vec3> sample) {
  Box box;
  std::vector<double> values(sample.size());
  for (int axis = 0; axis < 3; ++axis) {
    std::ranges::transform(sample, values.begin(), [axis](const Vec3& p) { return p[axis]; });
    const std::size_t cut = values.size() / 100;
    std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(cut));
    box.lo[axis] = values[cut];
    std::ranges::nth_element(values, values.end() - static_cast<std::ptrdiff_t>(cut + 1));
    box.hi[axis] = values[values.size() - 1 - cut];
  }
  return box;
}

bool contains(const Box& box, const Vec3& p) {
  return box.lo.x <= p.x && p.x <= box.hi.x && box.lo.y <= p.y && p.y <= box.hi.y && box.lo.z <= p.z && p.z <= box.hi.z;
}

/// Cells that hold a point when the largest extent of `box` is cut in `cells`.
std::size_t occupied_cells(std::span<const Vec3> points, const Box& box, double cells) {
  const Vec3 extent = box.extent();
  const double per_cell = cells / std::max({extent.x, extent.y, extent.z});
  std::vector<std::uint64_t> codes;
  codes.reserve(points.size());
  for (const Vec3& p : points) {
    std::uint64_t code = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double cell = std::min((p[axis] - box.lo[axis]) * per_cell, static_cast<double>(kMostCells - 1));
      code = code << 21 | static_cast<std::uint64_t>(cell);
    }
    codes.push_back(code);
  }
  std::ranges::sort(codes);
  return static_cast<std::size_t>(std::unique(codes.begin(), codes.end()) - codes.begin());
}

}  // namespace

double box_counting_dimension(std::span<const Vec3> sample) {
  constexpr double kUndecided = 2;
  if (sample.size() < kTooFew) return kUndecided;
  const Box box = quantile_box(sample);
  const Vec3 extent = box.extent();
  const double largest = std::max({extent.x, extent.y, extent.z});
  if (!(largest > 0) || !std::isfinite(largest)) return kUndecided;
  std::vector<Vec3> inside;
  for (std::size_t i = 0; i < sample.size(); i += sample.size() / kEnough + 1)
    if (contains(box, sample[i])) inside.push_back(sample[i]);

  // With fewer than about six points in a cell of the finer grid, cells that the surface meets begin to stay empty.
  const std::size_t wanted = inside.size() / 6;
  double cells = 2;
  std::size_t fine = occupied_cells(inside, box, cells);
  while (fine < wanted && cells < kMostCells / 2) fine = occupied_cells(inside, box, cells *= 2);
  if (fine < wanted) return kUndecided;
  for (std::size_t less = fine; less >= wanted && cells > 2; fine = less) {
    less = occupied_cells(inside, box, cells / 1.25);
    if (less < wanted) break;
    cells /= 1.25;
  }
  const std::size_t coarse = occupied_cells(inside, box, cells / 2);
  return std::clamp(std::log2(static_cast<double>(fine) / static_cast<double>(coarse)), 1.0, 3.0);
}

}  // namespace pointsweep
