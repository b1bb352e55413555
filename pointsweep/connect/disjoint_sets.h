// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

namespace pointsweep {

/// The representative of the set of i, in a forest of parents whose paths get shorter.
inline std::uint32_t set_of(std::vector<std::uint32_t>& parents, std::uint32_t i) {
  while (parents[i] != i) i = parents[i] = parents[parents[i]];
  return i;
}

}  // namespace pointsweep
