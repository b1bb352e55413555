// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/certificate.h"

namespace pointsweep {

Outside::Outside(const std::vector<Slab>& slabs, int axis) : slabs_(slabs), axis_(axis), dropped_(slabs.size()) {}

void Outside::cell_was_dropped(std::uint32_t slab, const Box& box) {
  if (dropped_[slab].empty()) dropping_slabs_.push_back(slab);
  dropped_[slab].push_back(box);
}

bool Outside::unread_within(const Box& box, double reach2) const {
  for (std::size_t s = read_; s < slabs_.size(); ++s) {
    const double ahead = slabs_[s].box.lo[axis_] - box.hi[axis_];
    if (ahead > 0 && ahead * ahead > reach2) return false;  // slabs ascend along the axis: the rest is farther still
    if (distance2(slabs_[s].box, box) <= reach2) return true;
  }
  return false;
}

void Outside::dropped_near(const Box& box, double reach2, std::vector<Box>& out) const {
  out.clear();
  for (const std::uint32_t slab : dropping_slabs_) {
    if (distance2(slabs_[slab].box, box) > reach2) continue;
    for (const Box& dropped : dropped_[slab]) {
      if (distance2(dropped, box) <= reach2) out.push_back(dropped);
    }
  }
}

}  // namespace pointsweep
