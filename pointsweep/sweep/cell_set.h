// SPDX-License-Identifier: MIT
/// Cells in memory, as searches and stages look at them.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "pointsweep/search/directory.h"
#include "pointsweep/sweep/window_cell.h"

namespace pointsweep {

/// Cells by slot. The window of a sweep and the region of a recall are such sets, so that the same functions search
/// their cells and take them through the steps. Reading is thread-safe, changing is not.
class CellSet {
 public:
  WindowCell& at(std::uint32_t slot) { return *cells_[slot]; }
  const WindowCell& at(std::uint32_t slot) const { return *cells_[slot]; }
  const CellDirectory& directory() const { return directory_; }
  const PointColumns* slots() const { return views_.data(); }  ///< by slot
  const std::vector<std::uint32_t>& occupied() const { return directory_.slots(); }
  std::uint32_t slot_count() const { return static_cast<std::uint32_t>(cells_.size()); }  ///< occupied or not
  std::uint64_t points() const { return points_; }

 protected:
  CellSet() = default;
  ~CellSet() = default;
  /// Puts the cell into a slot that a removed cell has left, or into the next new one.
  void add(std::unique_ptr<WindowCell> cell);
  void remove(std::uint32_t slot);

 private:
  std::uint32_t free_slot();

  std::vector<std::unique_ptr<WindowCell>> cells_;  ///< by slot
  std::vector<PointColumns> views_;                 ///< by slot
  std::vector<std::uint32_t> free_;
  CellDirectory directory_;
  std::uint64_t points_ = 0;
};

}  // namespace pointsweep
