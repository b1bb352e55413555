// SPDX-License-Identifier: MIT
#include "pointsweep/operator.h"

#include "pointsweep/points/degenerate_points.h"

namespace pointsweep {

void Columns::mark_degenerate(std::size_t i) {
  assert(i < size_);
  degenerate_->mark(i);
}

}  // namespace pointsweep
