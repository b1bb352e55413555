// SPDX-License-Identifier: MIT
#include "reference/audit.h"

#include <cassert>

namespace pointsweep::reference {

void Audit::arrived(StreamPoint& point) {
  NearestSet nearest({.k = 1, .radius2 = point.neighbors.reach2()});
  hidden_.find_nearest(point.input, nearest);
  if (nearest.full()) point.overlooked = nearest.found().front().rank();
  if (!any_written_) return;
  const double behind = point.input[sweep_axis_] - written_to_;
  point.written2 = behind * behind;
}

void Audit::completed(StreamPoint& point) {
  hidden_.insert(point);
  const NearestSet& set = point.neighbors;
  const bool misses = point.overlooked && (!set.full() || *point.overlooked < set.found().back().rank());
  if (misses) {
    ++overlooked_;
  } else if (set.reach2() < point.written2 || point.written2 == StreamPoint::kNothing) {
    ++complete_;
    point.complete = true;
  } else {
    ++unknown_;
  }
}

void Audit::written(const StreamPoint& point) {
  assert(&hidden_.smallest() == &point);
  hidden_.pop_smallest();
  written_to_ = point.input[sweep_axis_];
  any_written_ = true;
}

}  // namespace pointsweep::reference
