// SPDX-License-Identifier: MIT
/// The nearest points of chosen places by brute force: every point of a stream is compared with every place within
/// whose bound the point lies (and with some others). The search of the engine shares no code with it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "pointsweep/geometry.h"

namespace pointsweep {

/// Regular grids, whose cells are as wide as the extent of the centres divided by a power of two. A ball is listed in
/// the cells that it touches of the finest grid whose cells are at least as wide as the ball, so in at most 8. A query
/// visits one cell of each grid that lists a ball. Cells are hashed, so a query may also visit balls that are far away,
/// but it visits every ball that contains the point exactly once.
class BallIndex {
 public:
  /// Indexes balls around `centers` with squared radii `reach2`, which may be infinite. Balls are numbered from 0;
  /// there must be fewer than 2^28.
  BallIndex(const std::vector<Vec3>& centers, const std::vector<double>& reach2);

  /// Calls use(ball) for each ball with distance2(center, p) <= reach2, and for some others.
  template <class Use>
  void visit(Vec3 p, Use use) const {
    for (const Grid& grid : grids_) {
      const std::uint32_t bucket = grid.bucket(grid.cell(p, low_));
      for (std::uint32_t i = grid.begin[bucket]; i < grid.begin[bucket + 1]; ++i) use(grid.balls[i]);
    }
  }

 private:
  using Cell = std::array<std::uint32_t, 3>;

  struct Grid {
    double per_length = 0;             ///< number of cells per unit of length
    double last = 0;                   ///< greatest number of a cell; the cell also holds the points beyond it
    std::uint32_t mask = 0;            ///< number of buckets - 1
    std::vector<std::uint32_t> begin;  ///< first entry of each bucket in `balls`
    std::vector<std::uint32_t> balls;

    Cell cell(Vec3 p, Vec3 low) const { return {along(p.x, low.x), along(p.y, low.y), along(p.z, low.z)}; }
    /// Returns the number of the cell along an axis. It never descends as `value` ascends, so the cells of a ball form
    /// a range.
    std::uint32_t along(double value, double low) const {
      const double t = (value - low) * per_length;
      return t > 0 ? static_cast<std::uint32_t>(t < last ? t : last) : 0;
    }
    std::uint32_t bucket(Cell c) const {
      std::uint64_t h = c[0] * std::uint64_t{0x9e3779b97f4a7c15} + c[1] * std::uint64_t{0xc2b2ae3d27d4eb4f} +
                        c[2] * std::uint64_t{0x165667b19e3779f9};
      h ^= h >> 32;
      return static_cast<std::uint32_t>((h * std::uint64_t{0xd6e8feb86659fd93}) >> 32) & mask;
    }
  };

  void fill(Grid& grid, const std::vector<std::uint32_t>& members, const std::vector<Vec3>& centers,
            const std::vector<double>& radius) const;

  Vec3 low_;
  std::vector<Grid> grids_;
};

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
  std::vector<std::vector<NearPoint>> found_;  ///< points of each place; a heap, farthest first, unless most_ is kAll
  BallIndex index_;
};

/// Returns for each place an upper bound, at most `reach2`, of the squared distances of its `most` nearest points. The
/// bounds come from `some` points of the cloud; further points can only make them smaller.
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
