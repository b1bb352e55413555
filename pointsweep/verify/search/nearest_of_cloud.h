// SPDX-License-Identifier: MIT
/// The nearest points of a cloud for many places at once, by brute force.
#pragma once

#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "pointsweep/verify/search/nearest_in_stream.h"

namespace pointsweep {

/// A function that gives all points of a cloud, the same points each time.
using PointsOfCloud = std::function<void(const std::function<void(std::uint64_t row, Vec3 position)>& take)>;

struct NearestQuery {
  std::size_t most = 1;
  double reach2 = std::numeric_limits<double>::infinity();  ///< squared distance beyond which none is wanted
  NearestInStream::Space space = NearestInStream::Space::all;
};

/// Returns the nearest points of each place. Asks for the points twice: first for a thin subset of about `count`
/// points, which bounds the distances.
std::vector<std::vector<NearPoint>> nearest_of_cloud(std::span<const Vec3> places, const PointsOfCloud& points,
                                                     std::uint64_t count, const NearestQuery& query);

}  // namespace pointsweep
