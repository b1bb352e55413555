// SPDX-License-Identifier: MIT
/// The nearest points of chosen places by brute force: every point of a stream is held against every place that it
/// could still be near to. Shares nothing with the search of the engine.
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

  /// Compares by distance, then x, y, z, then row: the order of neighbours.
  friend bool operator<(const NearPoint& a, const NearPoint& b);
};

class NearestInStream {
 public:
  static constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();

  /// The space in which distances are measured. In the plane x and y alone count, and all places have z = 0.
  enum class Space : std::uint8_t { all, plane };

  /// Keeps the `most` nearest of each place among the points with distance2 <= reach2. Where the answer is known to lie
  /// nearer, a smaller reach2 saves work. About 40 bytes for each point kept.
  NearestInStream(std::vector<Vec3> places, std::vector<double> reach2, std::size_t most, Space space = Space::all);

  /// Offers one point of the stream, whose points come in any order; points that are not finite are neighbours of no
  /// point.
  void offer(Vec3 p, std::uint64_t row);
  /// Squared distance beyond which nothing is wanted any more at `place`.
  double reach2(std::size_t place) const { return reach2_[place]; }
  /// Returns the points found, nearest first; nothing may be offered afterwards.
  std::vector<NearPoint>& nearest(std::size_t place);

 private:
  std::vector<Vec3> places_;
  std::vector<double> reach2_;
  std::size_t most_;
  Space space_;
  std::vector<std::vector<NearPoint>> found_;  ///< heaps whose first is the farthest, once they are full
  BallIndex index_;
};

/// Returns for each place a squared distance within which its `most` nearest points lie, at most `reach2`: what holds
/// for some of the points is a bound for all.
std::vector<double> bounds_of_reach2(const std::vector<Vec3>& places, std::vector<double> reach2, std::size_t most,
                                     std::span<const KnownPoint> some,
                                     NearestInStream::Space space = NearestInStream::Space::all);

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
