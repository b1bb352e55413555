// SPDX-License-Identifier: MIT
/// Points and edges in buckets along an axis, and the forest that grows from them.
///
/// A point belongs to the bucket of its key. An edge lies in the bucket of its later end; if the other end is in an
/// earlier bucket, a mark there says until which bucket that point has edges. So when buckets are read in their order,
/// a point closes with its own bucket or the last that its marks name.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "pointsweep/connect/forest_edge.h"
#include "pointsweep/connect/spanning_forest.h"

namespace pointsweep {

/// `row`, of this bucket or an earlier one, has edges until the bucket `last`.
struct OpenUntil {
  std::uint64_t row;
  std::uint64_t last;
};

class BucketedGraph {
 public:
  virtual ~BucketedGraph() = default;

  /// Some points of one bucket, their ballots, and some marks.
  struct Points {
    std::vector<PointKey> points;
    std::vector<std::byte> ballots;
    std::vector<OpenUntil> marks;
  };
  virtual std::size_t buckets() const = 0;
  /// Returns the number of chunks of a bucket, each with some of its points, marks and edges.
  virtual std::size_t chunks(std::size_t bucket) const = 0;
  virtual void read_points(std::size_t bucket, std::size_t chunk, Points& out) const = 0;
  virtual void read_edges(std::size_t bucket, std::size_t chunk, std::vector<ForestEdge>& out) const = 0;
};

struct GrowthOptions {
  /// Says whether edges of a point come that are not in the graph, so that it does not close; empty: of no point.
  std::function<bool(std::uint64_t row)> stays_open = {};
  /// Called with the points that are known; may throw to end the work.
  std::function<void(std::uint64_t points)> progress = {};
};

/// Brings all points and edges of the graph to the forest. Returns the number of points.
std::uint64_t grow(SpanningForest& forest, const BucketedGraph& graph, const GrowthOptions& options);

}  // namespace pointsweep
