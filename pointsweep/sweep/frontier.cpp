// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/frontier.h"

#include <algorithm>
#include <utility>

namespace pointsweep {

Frontier::Frontier(const std::vector<Slab>& slabs, int axis, std::vector<Box> outside)
    : slabs_(slabs), axis_(axis), outside_(std::move(outside)), least_begin_(slabs.size()), dropped_(slabs.size()) {
  double least = Box::kInf;
  for (std::size_t s = slabs.size(); s-- > 0;) least_begin_[s] = least = std::min(least, slabs[s].box.lo[axis]);
}

void Frontier::cell_was_dropped(std::uint32_t slab, const DroppedCell& cell) {
  if (dropped_[slab].empty()) dropping_slabs_.push_back(slab);
  std::vector<DroppedCell>& cells = dropped_[slab];
  if (cells.size() == cells.capacity()) cells.reserve(cells.size() + std::max<std::size_t>(4, cells.size() / 8));
  cells.push_back(cell);
}

void Frontier::location_is_saturated(Vec3 place, std::uint64_t row) {
  const auto [at, is_new] = saturated_locations_.try_emplace({place.x, place.y, place.z}, row);
  if (!is_new) at->second = std::min(at->second, row);
}

bool Frontier::is_superfluous(const Box& box, std::uint64_t least_row) const {
  if (saturated_locations_.empty() || !(box.lo == box.hi)) return false;
  const auto at = saturated_locations_.find({box.lo.x, box.lo.y, box.lo.z});
  return at != saturated_locations_.end() && least_row > at->second;
}

bool Frontier::unread_within(const Box& box, double reach2, bool needed_only) const {
  for (std::size_t s = read_; s < slabs_.size(); ++s) {
    const double ahead = least_begin_[s] - box.hi[axis_];
    if (ahead > 0 && ahead * ahead > reach2) return false;
    if (distance2(slabs_[s].box, box) > reach2) continue;
    if (!needed_only || !is_superfluous(slabs_[s].box, slabs_[s].least_row)) return true;
  }
  return false;
}

bool Frontier::outside_within(const Box& box, double reach2) const {
  return std::ranges::any_of(outside_, [&](const Box& other) { return distance2(other, box) <= reach2; });
}

void Frontier::dropped_near(const Box& box, double reach2, std::vector<Box>& out) const {
  out.clear();
  for (const std::uint32_t slab : dropping_slabs_) {
    if (distance2(slabs_[slab].box, box) > reach2) continue;
    for (const DroppedCell& cell : dropped_[slab]) {
      if (distance2(cell.box, box) <= reach2) out.push_back(cell.box);
    }
  }
}

}  // namespace pointsweep
