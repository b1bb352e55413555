// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

namespace pointsweep {

/// Returns the representative of the set of i in a forest of parents. Shortens the paths that it follows.
inline std::uint32_t set_of(std::vector<std::uint32_t>& parents, std::uint32_t i) {
  while (parents[i] != i) i = parents[i] = parents[parents[i]];
  return i;
}

}  // namespace pointsweep
