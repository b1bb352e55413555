// SPDX-License-Identifier: MIT
/// The choice of the point that is kept, from the definitions of decimate, parts and voxel, and the means of a voxel.
#pragma once

#include <array>
#include <cstdint>

#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep::formulas {

using Coordinates = std::array<double, 3>;

/// The hash of the three coordinates, in [0, 2^64): three rounds of SplitMix64.
std::uint64_t hash_of(const Coordinates& p, std::uint64_t seed);

/// Returns whether `hash` / 2^64 < `share`, in the 53 bits that a float64 has.
bool is_in_share(std::uint64_t hash, double share);

/// Returns ⌊hash * parts / 2^64⌋; `parts` below 2^32.
std::uint64_t part_of(std::uint64_t hash, std::uint64_t parts);

/// The numbers of the voxel of edge length `size` that holds p.
Coordinates voxel_of(const Coordinates& p, double size);

/// The squared distance of p to the centre of its voxel.
double distance2_to_center(const Coordinates& p, double size);

/// The mean of finite values, float64: their exact sum, rounded, over their number, not below the least nor above the
/// greatest.
class Mean {
 public:
  void add(double value);
  /// The mean and how far it may be off; NaN without values.
  Estimate real() const;
  /// Returns the mean as float32.
  Estimate single() const;
  /// Returns the mean as a whole number, halves to even; open where rounding decides.
  Estimate whole() const;

 private:
  Real sum_ = 0, magnitudes_ = 0, count_ = 0;
  bool are_whole_ = true;  ///< all values are whole numbers
  double least_ = static_cast<double>(kInfinity), most_ = -static_cast<double>(kInfinity);
};

/// Three numbers as one estimate.
Estimate mean_vector(const std::array<Mean, 3>& components);
/// The mean vector divided by its length, float32; 0 where that is 0 or not a number.
Estimate mean_direction(const std::array<Mean, 3>& components);

}  // namespace pointsweep::formulas
