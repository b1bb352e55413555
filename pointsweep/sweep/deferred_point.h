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

/// A point that the stream cannot finish: its neighbourhood touches a box outside of the stream (Frontier), or a
/// neighbour was unresolved in the step before.
struct UnresolvedPoint {
  std::uint64_t row;
  std::uint32_t step;  ///< the first step it has not taken
  double reach2;       ///< its neighbourhood ends within it; infinite if unknown
};

}  // namespace pointsweep
