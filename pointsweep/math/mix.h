// SPDX-License-Identifier: MIT
/// Hashes of numbers and positions, which serve as pseudo-random numbers that are the same in every run.
#pragma once

#include <bit>
#include <cstdint>

#include "pointsweep/geometry.h"

namespace pointsweep {

/// Returns a bijective hash of 64-bit numbers without visible patterns (the output function of SplitMix64, Steele et
/// al. 2014).
inline std::uint64_t mix(std::uint64_t i) {
  i = (i + 0x9e3779b97f4a7c15u);
  i = (i ^ i >> 30) * 0xbf58476d1ce4e5b9u;
  i = (i ^ i >> 27) * 0x94d049bb133111ebu;
  return i ^ i >> 31;
}

/// Returns m(m(m(seed ^ x) ^ y) ^ z) of the bits of the coordinates in float64, with 0 for -0; m is mix(). Equal places
/// have equal hashes, in every file, tile and order of points.
inline std::uint64_t coordinate_hash(Vec3 p, std::uint64_t seed) {
  std::uint64_t hash = seed;
  for (const double c : {p.x, p.y, p.z}) hash = mix(hash ^ std::bit_cast<std::uint64_t>(c + 0.0));
  return hash;
}

/// Returns the first 53 bits of the hash as a fraction of 1, which is below 1.
inline double coordinate_fraction(Vec3 p, std::uint64_t seed) {
  return 0x1p-53 * static_cast<double>(coordinate_hash(p, seed) >> 11);
}

}  // namespace pointsweep
