// SPDX-License-Identifier: MIT
#include "pointsweep/search/expected_reach.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pointsweep {
namespace {

/// Factor on the radius of a ball that holds k points at the density of the leaf, because the ball of a point is not
/// centred in the leaf.
constexpr double kAllowance = 1.3;

/// Estimates the reach from the density of the leaf itself. Returns the larger of two estimates: one takes the points
/// of the leaf as a surface, one as a volume.
double expected_reach(const Cell& cell, std::uint32_t leaf, const Neighborhood& what) {
  double side[3];
  for (int a = 0; a < 3; ++a) side[a] = double{cell.leaf_box[a + 3][leaf]} - double{cell.leaf_box[a][leaf]};
  std::sort(side, side + 3);
  const double per_point = static_cast<double>(what.k) / cell.leaf_size(leaf);
  const double surface = std::sqrt(per_point * side[2] * side[1] / std::numbers::pi);
  const double volume = std::cbrt(per_point * side[2] * side[1] * side[0] * 3 / (4 * std::numbers::pi));
  return kAllowance * std::max(surface, volume);
}

}  // namespace

std::vector<double> expected_reaches(const Cell& cell, const Neighborhood& what) {
  std::vector<double> reach(cell.leaf_count(), what.radius);
  if (what.k == Neighborhood::kUnlimited) return reach;
  for (std::uint32_t l = 0; l < reach.size(); ++l) reach[l] = std::min(expected_reach(cell, l, what), what.radius);
  return reach;
}

}  // namespace pointsweep
