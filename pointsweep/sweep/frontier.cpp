// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/frontier.h"

#include <algorithm>

namespace pointsweep {

namespace {

std::vector<Box> boxes_from(const std::vector<Slab>& slabs, std::size_t first) {
  std::vector<Box> boxes;
  for (std::size_t s = first; s < slabs.size(); ++s) boxes.push_back(slabs[s].box);
  return boxes;
}

}  // namespace

Frontier::Frontier(const std::vector<Slab>& slabs, int axis, std::size_t swept_slabs)
    : slabs_(slabs),
      axis_(axis),
      swept_slabs_(swept_slabs),
      least_begin_(swept_slabs),
      beyond_(boxes_from(slabs, swept_slabs)),
      dropped_(slabs.size()) {
  double least = Box::kInf;
  for (std::size_t s = swept_slabs; s-- > 0;) least_begin_[s] = least = std::min(least, slabs[s].box.lo[axis]);
}

void Frontier::leave_unread_slabs() {
  for (; read_ < slabs_.size(); ++read_) {
    const Slab& slab = slabs_[read_];
    if (!is_superfluous(slab.box, slab.least_row))
      cell_was_dropped(static_cast<std::uint32_t>(read_), {slab.box, 0, static_cast<std::uint32_t>(slab.count)});
  }
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

bool Frontier::still_read_within(const Box& box, double reach2, bool needed_only) const {
  for (std::size_t s = read_; s < swept_slabs_; ++s) {
    const double ahead = least_begin_[s] - box.hi[axis_];
    if (ahead > 0 && ahead * ahead > reach2) break;
    if (distance2(slabs_[s].box, box) <= reach2 && counts(slabs_[s], needed_only)) return true;
  }
  return false;
}

bool Frontier::only_recalled_within(const Box& box, double reach2, bool needed_only) const {
  return read_ < slabs_.size() &&
         beyond_.any_within(box, reach2, [&](std::size_t i) { return counts(slabs_[swept_slabs_ + i], needed_only); });
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
