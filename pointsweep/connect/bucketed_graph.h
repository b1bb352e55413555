// SPDX-License-Identifier: MIT
/// Points and edges in buckets along an axis, and the forest that grows from them.
///
/// A point belongs to the bucket of its key. An edge lies in the bucket of its later end. If the other end lies in an
/// earlier bucket, that bucket holds a mark: the other end has edges up to the bucket of this edge. So when buckets are
/// read in order, the last edge of a point comes in the last bucket that its marks name; without marks, in its own
/// bucket.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "pointsweep/connect/edge_batch.h"
#include "pointsweep/connect/forest_edge.h"
#include "pointsweep/connect/spanning_forest.h"
#include "pointsweep/points/scratch.h"

namespace pointsweep {

/// A mark: the point with this row has edges in buckets up to number `last`.
struct OpenUntil {
  std::uint64_t row;
  std::uint64_t last;
};

class BucketedGraph {
 public:
  virtual ~BucketedGraph() = default;

  /// A chunk of a bucket: points, their ballots one after another (the input of VoteRule), and marks.
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
  /// Returns whether a point has edges outside of the graph, so that it must stay open (spanning_forest.h). If the
  /// function is empty, no point has edges outside of the graph.
  std::function<bool(std::uint64_t row)> stays_open = {};
  /// Receives the number of points that the forest has taken so far; may throw to end the work.
  std::function<void(std::uint64_t points)> progress = {};
};

/// Adds all points and edges of the graph to the forest. Returns the number of points.
std::uint64_t grow(SpanningForest& forest, const BucketedGraph& graph, const GrowthOptions& options);

/// A graph that is stored in the temporary folder until a forest is grown from it. The bucket of an edge does not
/// depend on the time at which the edge was found, so that a sweep may find edges in any order.
class EdgeBuckets final : public EdgeSink, public BucketedGraph {
 public:
  /// `begins`: the first key of each bucket after the first bucket, in any order. If not `weighted`, only the rows of
  /// the two ends of an edge are stored.
  EdgeBuckets(std::vector<PointKey> begins, int axis, bool weighted, std::size_t ballot_bytes,
              const MakeScratch& make_scratch);

  void put(const EdgeBatch& batch, std::size_t own, std::span<const std::byte> ballots) override;

  std::size_t buckets() const override { return places_.size(); }
  std::size_t chunks(std::size_t bucket) const override { return places_[bucket].size(); }
  void read_points(std::size_t bucket, std::size_t chunk, Points& out) const override;
  void read_edges(std::size_t bucket, std::size_t chunk, std::vector<ForestEdge>& out) const override;

  bool weighted() const override { return weighted_; }
  std::uint64_t bytes() const { return bytes_; }

 private:
  struct Chunk : Points {
    std::vector<ForestEdge> edges;
  };
  /// The place of a chunk in the scratch. The points, ballots, marks and edges of the chunk lie one after another.
  struct Place {
    std::uint64_t offset;
    std::uint32_t points, marks, edges;
  };
  std::size_t bucket_of(const PointKey& point) const;
  void put(std::size_t bucket, const Chunk& chunk);
  std::size_t bytes_before_edges(const Place& place) const {
    return place.points * (sizeof(PointKey) + ballot_bytes_) + place.marks * sizeof(OpenUntil);
  }
  std::size_t edge_bytes() const { return weighted_ ? sizeof(ForestEdge) : 2 * sizeof(std::uint64_t); }

  int axis_;
  bool weighted_;
  std::size_t ballot_bytes_;
  std::vector<PointKey> begins_;
  std::unique_ptr<Scratch> scratch_;
  std::mutex mutex_;
  std::vector<std::vector<Place>> places_;  ///< chunks of each bucket
  std::uint64_t bytes_ = 0;
};

}  // namespace pointsweep
