// SPDX-License-Identifier: MIT
/// The points that decimate, parts and voxel choose, the means of a voxel, and the levels of detail of points, from the
/// definitions of these operators.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep::formulas {

using Coordinates = std::array<double, 3>;

/// Returns a hash of n by SplitMix64.
std::uint64_t mixed(std::uint64_t n);

/// Returns a hash of the three coordinates in [0, 2^64): three rounds of SplitMix64.
std::uint64_t hash_of(const Coordinates& p, std::uint64_t seed);

/// Returns whether `hash` / 2^64 < `share`. Only the highest 53 bits of the hash count, as many as a float64 holds.
bool is_in_share(std::uint64_t hash, double share);

/// Returns ⌊hash * parts / 2^64⌋; `parts` below 2^32.
std::uint64_t part_of(std::uint64_t hash, std::uint64_t parts);

/// Returns the indices along x, y and z of the voxel with edge length `size` that holds p.
Coordinates voxel_of(const Coordinates& p, double size);

/// Returns the squared distance of p to the centre of its voxel.
double distance2_to_center(const Coordinates& p, double size);

/// The mean of the finite values among those added, float64: the rounded exact sum of the values divided by their
/// number, clamped to the range of the values.
class Mean {
 public:
  void add(double value);
  /// Returns the mean with its error; NaN without values.
  Estimate real() const;
  /// Returns the mean as float32.
  Estimate single() const;
  /// Returns the mean as a whole number, halves to even; open if rounding decides between two whole numbers.
  Estimate whole() const;

 private:
  Real sum_ = 0, magnitudes_ = 0, count_ = 0;
  bool are_whole_ = true;  ///< true if all values are whole numbers
  double least_ = static_cast<double>(kInfinity), most_ = -static_cast<double>(kInfinity);
};

/// Returns three means as one estimate.
Estimate mean_vector(const std::array<Mean, 3>& components);
/// Returns the mean vector divided by its length, float32; 0 if the length is 0 or not finite.
Estimate mean_direction(const std::array<Mean, 3>& components);

/// Bytes of memory that levels_of() takes for each point.
inline constexpr std::uint64_t kLevelBytes = 160;

/// Returns the level of detail that the operator level() gives each point: octants by division, leaves by counting,
/// points of a level by a loop over all points for each depth (for depth 0, one for each spacing that is tried). All
/// coordinates must be finite. Points with equal rounded coordinates are taken in the order of `points`.
std::vector<std::uint8_t> levels_of(const std::vector<Coordinates>& points);

}  // namespace pointsweep::formulas
