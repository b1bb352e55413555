// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <vector>

#include "pointsweep/math/box.h"
#include "pointsweep/math/sort.h"
#include "pointsweep/order/survey.h"

namespace pointsweep {
namespace {

constexpr std::size_t kTooFew = 256, kEnough = 16384;  ///< points
constexpr std::uint64_t kMostCells = 1u << 20;         ///< along one axis, so that three cell numbers fit 64 bits

bool contains(const Box& box, const Vec3& p) {
  return box.lo.x <= p.x && p.x <= box.hi.x && box.lo.y <= p.y && p.y <= box.hi.y && box.lo.z <= p.z && p.z <= box.hi.z;
}

/// Returns the number of cells with a point if the largest extent of `box` is divided into `cells`.
std::size_t occupied_cells(std::span<const Vec3> points, const Box& box, std::uint64_t cells) {
  const Vec3 extent = box.extent();
  const double largest = std::max({extent.x, extent.y, extent.z});
  const auto last = static_cast<double>(cells - 1);
  std::vector<std::uint64_t> codes;
  codes.reserve(points.size());
  for (const Vec3& p : points) {
    std::uint64_t code = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double cell = std::min((p[axis] - box.lo[axis]) / largest * static_cast<double>(cells), last);
      code = code << 21 | static_cast<std::uint64_t>(cell);
    }
    codes.push_back(code);
  }
  sort_ascending(std::span(codes));
  return static_cast<std::size_t>(std::unique(codes.begin(), codes.end()) - codes.begin());
}

}  // namespace

double box_counting_dimension(std::span<const Vec3> sample) {
  constexpr double kUndecided = 2;
  if (sample.size() < kTooFew) return kUndecided;
  const Box box = middle_box(sample);
  const Vec3 extent = box.extent();
  const double largest = std::max({extent.x, extent.y, extent.z});
  if (!(largest > 0) || !std::isfinite(largest)) return kUndecided;
  std::vector<Vec3> inside;
  for (std::size_t i = 0; i < sample.size(); i += sample.size() / kEnough + 1)
    if (contains(box, sample[i])) inside.push_back(sample[i]);
  if (inside.size() < kTooFew / 2) return kUndecided;

  // With fewer than about eight points per cell of the finer grid, some cells that the surface crosses would contain no
  // sample point. The numbers of cells are whole, since a cell cut off by the end of the grid would count as full.
  const std::size_t wanted = inside.size() / 8;
  std::uint64_t coarse_cells = 1;
  while (occupied_cells(inside, box, 2 * coarse_cells) < wanted && coarse_cells < kMostCells / 4) coarse_cells *= 2;
  for (std::uint64_t step = coarse_cells / 4; step >= 1 && step * 16 > coarse_cells; step /= 2)
    if (occupied_cells(inside, box, 2 * (coarse_cells - step)) >= wanted) coarse_cells -= step;
  const std::size_t fine = occupied_cells(inside, box, 2 * coarse_cells);
  if (fine < wanted) return kUndecided;
  const std::size_t coarse = occupied_cells(inside, box, coarse_cells);
  return std::clamp(std::log2(static_cast<double>(fine) / static_cast<double>(coarse)), 1.0, 3.0);
}

}  // namespace pointsweep
