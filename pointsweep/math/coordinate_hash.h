// SPDX-License-Identifier: MIT
/// A number for each place in space that looks random and depends on its three coordinates alone.
#pragma once

#include <bit>
#include <cstdint>

#include "pointsweep/geometry.h"
#include "pointsweep/math/mix.h"

namespace pointsweep {

/// m(m(m(seed ^ x) ^ y) ^ z) of the bits of the coordinates in float64, with 0 for -0; m is mix(). Equal places have
/// equal hashes, in every file, tile and order of points.
inline std::uint64_t coordinate_hash(Vec3 p, std::uint64_t seed) {
  std::uint64_t hash = seed;
  for (const double c : {p.x, p.y, p.z}) hash = mix(hash ^ std::bit_cast<std::uint64_t>(c + 0.0));
  return hash;
}

}  // namespace pointsweep
