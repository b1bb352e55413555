// SPDX-License-Identifier: MIT
/// A point that the sweep could not finish: its neighbourhood touches something already dropped or not read in time.
#pragma once

#include <cstdint>

#include "pointsweep/geometry.h"

namespace pointsweep {

struct DeferredPoint {
  Vec3 position;
  std::uint64_t row;
  std::uint32_t slab;
  std::uint32_t index_in_slab;
  double reach2;       ///< its neighbourhood ends within it; infinite if unknown
  std::uint32_t step;  ///< the first step it has not taken
};

}  // namespace pointsweep
