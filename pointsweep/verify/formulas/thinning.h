// SPDX-License-Identifier: MIT
/// The choice of the point that stays of several, from the definitions of decimate and voxel.
#pragma once

#include <array>
#include <cstdint>

namespace pointsweep::formulas {

using Coordinates = std::array<double, 3>;

/// The hash of the three coordinates, in [0, 2^64): three rounds of SplitMix64.
std::uint64_t hash_of(const Coordinates& p, std::uint64_t seed);

/// Returns whether `hash` / 2^64 < `share`, in the 53 bits that a float64 has.
bool is_in_share(std::uint64_t hash, double share);

/// The numbers of the voxel of edge length `size` that holds p.
Coordinates voxel_of(const Coordinates& p, double size);

/// The squared distance of p to the centre of its voxel.
double distance2_to_center(const Coordinates& p, double size);

}  // namespace pointsweep::formulas
