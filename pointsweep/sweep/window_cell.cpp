// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/window_cell.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

constexpr std::uint32_t kMostSlots = 1u << (32 - kIndexBits);  ///< number of slots that a NeighborRef can name

/// Returns a bound of the reaches of all leaves except about one in kStragglers. The points of the excepted leaves may
/// be deferred.
double reach_of_most(std::vector<double> reach) {
  const auto most = reach.begin() + static_cast<std::ptrdiff_t>(reach.size() * (kStragglers - 1) / kStragglers);
  std::nth_element(reach.begin(), most, reach.end());
  return *most;
}

/// Factor on the radius of a ball that holds k points at the density of a leaf. It allows for balls of points that are
/// not centred in the leaf.
constexpr double kAllowance = 1.3;

/// Estimates the reach from the density of the leaf. Returns the larger of two estimates: one for points on a surface,
/// one for points in a volume.
double expected_reach(const Cell& cell, std::uint32_t leaf, const Neighborhood& what) {
  double side[3];
  for (int a = 0; a < 3; ++a) side[a] = double{cell.leaf_box[a + 3][leaf]} - double{cell.leaf_box[a][leaf]};
  std::sort(side, side + 3);
  const double per_point = static_cast<double>(what.k) / cell.leaf_size(leaf);
  const double surface = std::sqrt(per_point * side[2] * side[1] / std::numbers::pi);
  const double cubed = per_point * side[2] * side[1] * side[0] * 3 / (4 * std::numbers::pi);
  if (cubed <= surface * surface * surface) return kAllowance * surface;  // most leaves of surfaces need no cube root
  return kAllowance * std::cbrt(cubed);
}

}  // namespace

void expect_reaches(WindowCell& cell, const Neighborhood& what) {
  const Cell& points = cell.cell;
  cell.leaf_reach.assign(points.leaf_count(), what.radius);
  if (what.k != Neighborhood::kUnlimited)
    for (std::uint32_t l = 0; l < cell.leaf_reach.size(); ++l)
      cell.leaf_reach[l] = std::min(expected_reach(points, l, what), what.radius);
  cell.wait_reach = reach_of_most(cell.leaf_reach);
}

std::uint32_t CellSet::free_slot() {
  if (!free_.empty()) {
    const std::uint32_t slot = free_.back();
    free_.pop_back();
    return slot;
  }
  const auto slot = static_cast<std::uint32_t>(cells_.size());
  if (slot >= kMostSlots)
    fail("The neighbourhoods reach so far that more than {} cells are in memory at once: choose a smaller radius or k.",
         kMostSlots);
  cells_.emplace_back();
  views_.emplace_back();
  return slot;
}

void CellSet::add(std::unique_ptr<WindowCell> cell) {
  const std::uint32_t slot = free_slot();
  points_ += cell->cell.size();
  directory_.add(slot, &cell->cell);
  views_[slot] = cell->view();
  cells_[slot] = std::move(cell);
}

void CellSet::remove(std::uint32_t slot) {
  directory_.remove(slot);
  points_ -= cells_[slot]->cell.size();
  cells_[slot].reset();
  free_.push_back(slot);
}

}  // namespace pointsweep
