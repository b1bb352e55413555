// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/certificate.h"

namespace pointsweep {

Outside::Outside(const std::vector<Slab>& slabs, int axis) : slabs_(slabs), axis_(axis), dropped_(slabs.size()) {}

void Outside::cell_was_dropped(std::uint32_t slab, const Box& box) {
  if (dropped_[slab].empty()) dropping_slabs_.push_back(slab);
  dropped_[slab].push_back(box);
}

double Outside::unread_distance2(const Box& box, double reach2) const {
  double nearest = Box::kInf;
  for (std::size_t s = read_; s < slabs_.size(); ++s) {
    const double ahead = slabs_[s].box.lo[axis_] - box.hi[axis_];
    if (ahead > 0 && ahead * ahead > reach2) break;  // slabs ascend along the axis: the rest is farther still
    nearest = std::min(nearest, distance2(slabs_[s].box, box));
    if (nearest <= reach2) break;
  }
  return nearest;
}

bool Outside::unread_within(Vec3 p, double reach2) const { return unread_distance2({p, p}, reach2) <= reach2; }

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
