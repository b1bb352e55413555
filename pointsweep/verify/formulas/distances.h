// SPDX-License-Identifier: MIT
/// Distances to neighbours, measures of how crowded points are, and rules that shorten neighbourhoods.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep::formulas {

/// Returns |q - p|² with the rounding with which distances are compared: ((dx² + dy²) + dz²), every operation rounded
/// to float64.
double squared_distance(const Place& p, const Place& q);

/// Returns |q - p|, float64: the square root of the squared distance, rounded. For points that an operator has moved,
/// the error includes the errors of their positions.
Estimate distance(const Place& p, const Place& q);

/// Returns the distance to the farthest of `neighbors`, float64; 0 without neighbours, NaN if a distance is NaN, as it
/// can be for points that an operator has moved.
Estimate farthest(const Place& p, std::span<const Place> neighbors);

/// The programs whose definitions of a statistical outlier the operator can follow.
enum class OutlierProgram { pointsweep, pdal, pcl, open3d, cloudcompare };

/// Returns the mean distance to `neighbors`, float64; NaN without neighbours, or if the mean is not finite. In Open3D
/// the point itself counts as a further neighbour at distance 0.
Estimate mean_distance(const Place& p, std::span<const Place> neighbors, bool of_open3d);

/// Returns 1 for the mean distance of an outlier, else 0. An outlier has a distance of NaN or above the threshold; in
/// PDAL and Open3D also equal to the threshold; in Open3D also 0. Open if errors decide or if the threshold is NaN,
/// unless Open3D's 0 decides.
Estimate outlier(const Estimate& mean_distance, Real threshold, Real threshold_error, OutlierProgram program);

/// A neighbour in a row of the neighbour graph.
struct GraphNeighbor {
  Estimate distance;
  double distance2;
  std::size_t index;  ///< index in the list `neighbors` that graph_row() takes
};

/// A row of the neighbour graph: neighbours ordered by ((dx² + dy²) + dz²) in float64, equal distances by x, y, z, then
/// row; points at a distance of NaN last, by row. `certain` is false if errors of positions may change the order.
struct GraphRow {
  std::vector<GraphNeighbor> neighbors;
  bool certain = true;
};
GraphRow graph_row(const Place& p, std::span<const Place> neighbors, std::span<const std::uint64_t> rows);

/// The number of neighbours that a rule keeps, counted from the nearest.
struct Kept {
  std::size_t count = 0;
  bool certain = true;  ///< false if rounding decides between this and another count
};

/// Returns the smallest k from `least` to |neighbors| at which the eigenentropy E = -Σ e ln e is least, where e are the
/// eigenvalues, divided by their sum, of the covariance of p and its k nearest neighbours about their mean (Weinmann et
/// al. 2014). `neighbors` come nearest first. E is undefined for a k whose neighbours all coincide with p. All
/// neighbours are kept if they are fewer than `least`, or if E is undefined for each k.
Kept of_least_eigenentropy(const Place& p, std::span<const Place> neighbors, std::size_t least);

/// Returns the number of neighbours within both limits: the first floor(k), and neighbours with ((dx² + dy²) + dz²) <=
/// radius · radius in float64. A limit that is not given allows all neighbours. `neighbors` come nearest first. A k
/// below 1, a negative radius and NaN allow no neighbour.
Kept within_limits(const Place& p, std::span<const Place> neighbors, std::optional<double> k,
                   std::optional<double> radius);

/// Returns 1 if fewer than `least` of the neighbours lie within `radius`, inclusive, else 0.
Estimate radius_outlier(const Place& p, std::span<const Place> neighbors, double radius, std::size_t least);
/// Returns 1 if at least `least` points, including the point itself, lie within eps, else 0.
Estimate core_point(const Place& p, std::span<const Place> neighbors, double eps, std::size_t least);

struct Densities {
  Estimate surface, volume;
};
/// Returns m / (π R²) and m / (4/3 π R³), as float32 and at most the largest float32. With a radius, R is the radius
/// and m the number of points within it, p included. Without a radius, R is the distance of the farthest neighbour and
/// m the number of neighbours. Both are 0 if R is 0 or not finite.
Densities densities(const Place& p, std::span<const Place> neighbors, std::optional<double> radius);

/// Returns the distance to the farthest of the neighbours, float64; NaN without neighbours, or if it is not finite.
Estimate k_distance(const Place& p, std::span<const Place> neighbors);
/// Returns |N| / Σ_j max(k_distance of j, |q_j - p|), float64; infinite if the sum is 0, NaN without neighbours or if
/// the sum is not finite.
Estimate reachability_density(const Place& p, std::span<const Place> neighbors, std::span<const Estimate> k_distances);
/// Returns 1/|N| Σ_j r_j / r, float64, where r and r_j are the densities of the point and its neighbours; the quotient
/// of two infinite densities is 1. NaN without neighbours or if one of the densities is NaN.
Estimate local_outlier_factor(const Estimate& density, std::span<const Estimate> of_neighbors);

}  // namespace pointsweep::formulas
