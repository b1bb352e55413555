// SPDX-License-Identifier: MIT
#include "pointsweep/search/directory.h"

#include <algorithm>
#include <cassert>

namespace pointsweep {

void CellDirectory::add(std::uint32_t slot, const Cell* cell) {
  if (slot >= cells_.size()) {
    cells_.resize(slot + 1, nullptr);
    position_.resize(slot + 1, 0);
  }
  assert(cells_[slot] == nullptr);
  cells_[slot] = cell;
  position_[slot] = static_cast<std::uint32_t>(slots_.size());
  slots_.push_back(slot);
  for (int a = 0; a < 3; ++a) {
    side_[a].push_back(cell->box.lo[a]);
    side_[a + 3].push_back(cell->box.hi[a]);
  }
}

void CellDirectory::remove(std::uint32_t slot) {
  const std::uint32_t at = position_[slot];
  for (auto& side : side_) {
    side[at] = side.back();
    side.pop_back();
  }
  slots_[at] = slots_.back();
  position_[slots_[at]] = at;
  slots_.pop_back();
  cells_[slot] = nullptr;
}

void CellDirectory::find(const Box& box, double reach2, std::vector<Near>& out) const {
  out.clear();
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    const double dx = std::max(std::max(side_[0][i] - box.hi.x, box.lo.x - side_[3][i]), 0.0);
    const double dy = std::max(std::max(side_[1][i] - box.hi.y, box.lo.y - side_[4][i]), 0.0);
    const double dz = std::max(std::max(side_[2][i] - box.hi.z, box.lo.z - side_[5][i]), 0.0);
    const double d2 = (dx * dx + dy * dy) + dz * dz;
    if (d2 <= reach2) out.push_back({d2, slots_[i]});
  }
  std::sort(out.begin(), out.end());
}

}  // namespace pointsweep
