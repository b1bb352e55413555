// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/window_cell.h"

#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

constexpr std::uint32_t kMostSlots = 1u << (32 - kIndexBits);  ///< number of slots that a NeighborRef can name

}  // namespace

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
