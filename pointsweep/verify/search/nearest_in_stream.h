// SPDX-License-Identifier: MIT
/// The nearest points of chosen places by brute force: every point of a stream is compared with every place within
/// whose bound the point lies. The search of the engine shares no code with it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/verify/search/ball_index.h"

namespace pointsweep {

/// A finite point of a cloud.
struct KnownPoint {
  Vec3 position;
  std::uint64_t row;
};

struct NearPoint {
  double distance2;
  Vec3 position;
  std::uint64_t row;

  /// Orders by distance, then x, y, z, then row: the order of neighbours.
  friend bool operator<(const NearPoint& a, const NearPoint& b);
};

class NearestInStream {
 public:
  static constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();

  /// The space in which distances are measured: in `plane`, only x and y count, and all places must have z = 0.
  enum class Space : std::uint8_t { all, plane };

  /// Keeps the `most` nearest points of each place among points with distance2 <= reach2. A smaller reach2 saves work.
  /// Memory: about 40 bytes for each kept point.
  NearestInStream(std::vector<Vec3> places, std::vector<double> reach2, std::size_t most, Space space = Space::all);

  /// Takes one point of the stream; points come in any order. Points that are not finite are ignored.
  void offer(Vec3 p, std::uint64_t row);
  /// Returns the squared distance beyond which points cannot be among the nearest of `place`.
  double reach2(std::size_t place) const { return reach2_[place]; }
  /// Returns the points found, nearest first. No point may be offered afterwards.
  std::vector<NearPoint>& nearest(std::size_t place);

 private:
  std::vector<Vec3> places_;
  std::vector<double> reach2_;
  std::size_t most_;
  Space space_;
  std::vector<std::vector<NearPoint>> found_;  ///< points of each place; once full, a heap with the farthest in front
  BallIndex index_;
};

/// Returns for each place an upper bound, at most `reach2`, of the squared distances of its `most` nearest points. A
/// bound that some points give holds for all points.
std::vector<double> bounds_of_reach2(const std::vector<Vec3>& places, std::vector<double> reach2, std::size_t most,
                                     std::span<const KnownPoint> some,
                                     NearestInStream::Space space = NearestInStream::Space::all);

/// A function that passes all points of a cloud to `take`, the same points each time.
using PointsOfCloud = std::function<void(const std::function<void(std::uint64_t row, Vec3 position)>& take)>;

struct NearestQuery {
  std::size_t most = 1;
  double reach2 = std::numeric_limits<double>::infinity();  ///< squared distance beyond which no point is needed
  NearestInStream::Space space = NearestInStream::Space::all;
};

/// Returns the nearest points of each place. Reads the points twice: in the first reading an evenly spaced subset
/// bounds the distances. `count`: about the number of points.
std::vector<std::vector<NearPoint>> nearest_of_cloud(std::span<const Vec3> places, const PointsOfCloud& points,
                                                     std::uint64_t count, const NearestQuery& query);

}  // namespace pointsweep
