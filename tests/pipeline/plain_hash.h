// SPDX-License-Identifier: MIT
/// The hash of decimate, voxel and poisson, written from its definition.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>

namespace pointsweep {

/// SplitMix64 by division and 128-bit products.
inline std::uint64_t plain_hash(const std::array<double, 3>& p, std::uint64_t seed) {
  using Wide = unsigned __int128;
  const auto times = [](std::uint64_t a, std::uint64_t b) { return static_cast<std::uint64_t>(Wide{a} * b); };
  std::uint64_t h = seed;
  for (const double c : p) {
    std::uint64_t bits = 0;
    if (c != 0) std::memcpy(&bits, &c, sizeof bits);
    std::uint64_t j = (h ^ bits) + 0x9e3779b97f4a7c15u;
    j = times(j ^ (j / (1u << 30)), 0xbf58476d1ce4e5b9u);
    j = times(j ^ (j / (1u << 27)), 0x94d049bb133111ebu);
    h = j ^ (j / (std::uint64_t{1} << 31));
  }
  return h;
}

}  // namespace pointsweep
