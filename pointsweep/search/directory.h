// SPDX-License-Identifier: MIT
/// The cells that a search may visit, with a look-up of the cells near a box.
#pragma once

#include <cstdint>
#include <vector>

#include "pointsweep/math/box.h"
#include "pointsweep/search/cell.h"

namespace pointsweep {

/// A flat table of cells with their boxes as structure of arrays. A window has some hundreds of cells, so that a linear
/// scan per query cell costs a few nanoseconds per point, less than walking any tree. Reading is thread-safe, changing
/// is not.
class CellDirectory {
 public:
  struct Near {
    double distance2;  ///< squared distance between the box of the query and the box of the cell
    std::uint32_t slot;
    friend bool operator<(const Near& a, const Near& b) {
      return a.distance2 != b.distance2 ? a.distance2 < b.distance2 : a.slot < b.slot;
    }
  };

  /// Adds a cell under a slot number that no other cell has. The cell is borrowed and must not move.
  void add(std::uint32_t slot, const Cell* cell);
  void remove(std::uint32_t slot);
  const Cell& cell(std::uint32_t slot) const { return *cells_[slot]; }
  bool contains(std::uint32_t slot) const { return slot < cells_.size() && cells_[slot] != nullptr; }
  std::size_t size() const { return slots_.size(); }
  const std::vector<std::uint32_t>& slots() const { return slots_; }

  /// Finds all cells whose box is within sqrt(reach2) of `box`, nearest first (equal distances by slot).
  void find(const Box& box, double reach2, std::vector<Near>& out) const;

 private:
  std::vector<const Cell*> cells_;       ///< cell in each slot; null in a free slot
  std::vector<std::uint32_t> position_;  ///< for each slot, index of its cell in `slots_` and `side_`
  std::vector<std::uint32_t> slots_;
  std::vector<double> side_[6];  ///< sides of the boxes of the cells: lo x, y, z, hi x, y, z
};

}  // namespace pointsweep
