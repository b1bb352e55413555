// SPDX-License-Identifier: MIT
/// Measures of how crowded points are: radius outliers, densities, local outlier factors.
#pragma once

#include <optional>

#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep::formulas {

/// 1 if fewer than `least` of the neighbours lie within `radius`, inclusive, else 0.
Estimate radius_outlier(const Place& p, std::span<const Place> neighbors, double radius, std::size_t least);
/// 1 where at least `least` points, the point itself counted, lie within eps; else 0.
Estimate core_point(const Place& p, std::span<const Place> neighbors, double eps, std::size_t least);

struct Densities {
  Estimate surface, volume;
};
/// m / (π R²) and m / (4/3 π R³), float32. With a radius R is that, and m the neighbours within it and p; without one R
/// is the distance of the farthest neighbour and m their number. 0 where R is 0 or not finite.
Densities densities(const Place& p, std::span<const Place> neighbors, std::optional<double> radius);

/// Distance to the farthest of the neighbours, float64; NaN without any, or if that is not finite.
Estimate k_distance(const Place& p, std::span<const Place> neighbors);
/// |N| / Σ_j max(k_distance of j, |q_j - p|), float64; infinite where the sum is 0, NaN where it is not finite.
Estimate reachability_density(const Place& p, std::span<const Place> neighbors, std::span<const Estimate> k_distances);
/// 1/|N| Σ_j r_j / r, float64; the quotient of two infinite densities is 1.
Estimate local_outlier_factor(const Estimate& density, std::span<const Estimate> of_neighbors);

}  // namespace pointsweep::formulas
