// SPDX-License-Identifier: MIT
/// Distances to neighbours: for the neighbour graph and for the size of a neighbourhood.
#pragma once

#include <cstdint>
#include <vector>

#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep::formulas {

/// |q - p|² as every exact comparison takes it: ((dx² + dy²) + dz²), every operation rounded to float64.
double squared_distance(const Place& p, const Place& q);

/// |q - p|, float64: its square root, rounded to float64. Of points that an operator moved it is right up to what they
/// may be off.
Estimate distance(const Place& p, const Place& q);

/// The farthest of `neighbors`, float64; 0 without any, NaN if one of them, moved, has no finite place.
Estimate farthest(const Place& p, std::span<const Place> neighbors);

/// The programs whose statistical outliers differ.
enum class OutlierProgram { pointsweep, pdal, pcl, open3d, cloudcompare };

/// The mean distance to `neighbors`, float64; NaN without any, or if one of them, moved, has no finite place. In Open3D
/// the point itself is one more neighbour at distance 0.
Estimate mean_distance(const Place& p, std::span<const Place> neighbors, bool of_open3d);

/// Returns 1 for the mean distance of an outlier: if it is NaN or above the threshold, in PDAL and Open3D also at the
/// threshold, in Open3D also if it is 0; else 0. Open if the threshold is NaN.
Estimate outlier(const Estimate& mean_distance, Real threshold, Real threshold_error, OutlierProgram program);

/// A neighbour in the graph.
struct GraphNeighbor {
  Estimate distance;
  double distance2;
  std::size_t index;  ///< in the list given
};

/// Nearest first by ((dx² + dy²) + dz²) in float64, equal ones by x, y, z, then row; those without a finite place last,
/// by row. `certain` is false if points may be off by more than what their order hangs on.
struct GraphRow {
  std::vector<GraphNeighbor> neighbors;
  bool certain = true;
};
GraphRow graph_row(const Place& p, std::span<const Place> neighbors, std::span<const std::uint64_t> rows);

}  // namespace pointsweep::formulas
