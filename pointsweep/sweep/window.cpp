// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/window.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pointsweep/fail.h"
#include "pointsweep/threads.h"

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

/// Factor on the radius of a ball that holds k points at the density of a leaf. The factor allows for points
/// that are not in the middle of the leaf.
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

/// Factor of reaches: a cell whose reach is this many times shorter than the reach of a leaf counts as much denser. On
/// a surface, such a cell has 100 times as many points per area. With 4, the recall of a terrestrial scan of 400 million
/// points read three quarters of them again, for 40,000 points far from the scanner.
constexpr double kMuchDenser = 10;

/// The factor on expected reaches grows while more than one in kManyWaiting searched cells must wait, and shrinks while
/// fewer than one in kFewWaiting must. It stays between 1 and kMostAllowed.
constexpr std::size_t kManyWaiting = 8, kFewWaiting = 32;
constexpr double kMostAllowed = 3;

Box leaf_box(const Cell& cell, std::uint32_t leaf) {
  Box b;
  for (int a = 0; a < 3; ++a) {
    b.lo[a] = cell.origin[a] + double{cell.leaf_box[a][leaf]};
    b.hi[a] = cell.origin[a] + double{cell.leaf_box[a + 3][leaf]};
  }
  return b;
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

void Window::admit(std::unique_ptr<WindowCell> cell) {
  note_saturated_location(*cell);
  cell->read_at = std::chrono::steady_clock::now();
  add(std::move(cell));
}

/// Records the location of a cell whose more than k points all coincide. A point at this location whose row is higher
/// than the rows of k + 1 points of the cell can never be a neighbour.
void Window::note_saturated_location(const WindowCell& cell) {
  const std::size_t k = plan_.neighborhood.k;
  if (cell.cell.lowest_row == Cell::kSeveralPlaces || cell.cell.size() <= k) return;
  frontier_.location_is_saturated(cell.cell.box.lo, cell.cell.row[k]);
}

bool Window::ready(const WindowCell& cell, std::uint32_t step) const {
  if (cell.steps_done != step) return false;
  if (step == 0) {
    if (!frontier_.more_to_read()) return true;
    if (cell.is_only_looked_at && plan_.step_count() == 1) return true;
    const bool is_expected = cell.wait_for_slabs == 0;  // otherwise a search has found the reach
    const double reach = is_expected ? allowance_ * cell.wait_reach : cell.wait_reach;
    return frontier_.slabs_read() >= cell.wait_for_slabs && !frontier_.still_read_within(cell.cell.box, reach * reach);
  }
  return std::all_of(cell.refers_to.begin(), cell.refers_to.end(),
                     [&](std::uint32_t slot) { return at(slot).steps_done >= step; });
}

std::vector<std::uint32_t> Window::ready_for(std::uint32_t step) const {
  std::vector<std::uint32_t> slots;
  for (const std::uint32_t slot : occupied()) {
    if (ready(at(slot), step)) slots.push_back(slot);
  }
  std::sort(slots.begin(), slots.end());
  return slots;
}

void Window::note_searched(const std::vector<std::uint32_t>& slots) {
  const auto waiting = static_cast<std::size_t>(
      std::count_if(slots.begin(), slots.end(), [&](std::uint32_t slot) { return at(slot).steps_done == 0; }));
  if (waiting * kManyWaiting > slots.size())
    allowance_ = std::min(1.05 * allowance_, kMostAllowed);
  else if (waiting * kFewWaiting < slots.size())
    allowance_ = std::max(0.99 * allowance_, 1.0);
}

/// Returns the distance within which later points may search a cell of this reach. Without a limit k: the radius plus a
/// margin for rounding. Otherwise an estimate: twice the reach at the density of the cell.
double Window::kept_clear(double reach) const {
  return (plan_.neighborhood.k == Neighborhood::kUnlimited ? 1 + 1e-9 : 2) * reach;
}

/// Returns whether a waiting cell will probably search `cell`. Each leaf is tested separately, since a cell may have a
/// dense and a sparse end. A leaf needs cells within kept_clear() of its reach. Much denser cells
/// (kMuchDenser) are not kept for the leaf: its few points whose balls touch dropped cells are recalled instead.
bool Window::asks_for(const WindowCell& waiting, const WindowCell& cell) const {
  const double most = kMuchDenser * cell.reach;
  if (distance2(waiting.cell.box, cell.cell.box) > most * most) return false;
  for (std::uint32_t l = 0; l < waiting.cell.leaf_count(); ++l) {
    const double reach = waiting.leaf_reach[l], asked = std::min(kept_clear(reach), most);
    if (reach <= most && distance2(leaf_box(waiting.cell, l), cell.cell.box) <= asked * asked) return true;
  }
  return false;
}

/// Returns whether a later point may need a finished cell: an unread slab lies within kept_clear() of the cell, or a
/// waiting cell will probably search it.
bool Window::still_needed(const WindowCell& cell, const std::vector<const WindowCell*>& unsearched) const {
  const double own = kept_clear(cell.reach);
  return (frontier_.more_to_read() && frontier_.anything_unread_within(cell.cell.box, own * own)) ||
         std::any_of(unsearched.begin(), unsearched.end(),
                     [&](const WindowCell* waiting) { return asks_for(*waiting, cell); });
}

void Window::drop() {
  std::vector<std::uint8_t> referred(slot_count(), 0);
  std::vector<const WindowCell*> unsearched;
  for (const std::uint32_t slot : occupied()) {
    const WindowCell& cell = at(slot);
    if (cell.steps_done == 0) unsearched.push_back(&cell);
    if (cell.steps_done == plan_.step_count()) continue;
    for (const std::uint32_t other : cell.refers_to) referred[other] = 1;
  }
  const std::vector<std::uint32_t> slots = occupied();
  std::vector<std::uint8_t> leaves(slots.size(), 0);
  parallel_for(slots.size(), [&](std::size_t i, unsigned) {
    const WindowCell& cell = at(slots[i]);
    if (cell.steps_done < plan_.step_count() || referred[slots[i]]) return;
    leaves[i] = frontier_.is_superfluous(cell.cell.box, cell.cell.lowest_row) || !still_needed(cell, unsearched);
  });
  const auto now = std::chrono::steady_clock::now();
  for (std::size_t i = 0; i < slots.size(); ++i) {
    if (leaves[i] == 0) continue;
    const std::uint32_t slot = slots[i];
    const WindowCell& cell = at(slot);
    const double lifespan = std::chrono::duration<double>(now - cell.read_at).count();
    lifespan_sum_ += lifespan * cell.cell.size();
    lifespan_max_ = std::max(lifespan_max_, lifespan);
    if (!frontier_.is_superfluous(cell.cell.box, cell.cell.lowest_row)) {
      frontier_.cell_was_dropped(cell.slab, {cell.cell.box, cell.number, cell.cell.size()});
    }
    remove(slot);
  }
}

}  // namespace pointsweep
