// SPDX-License-Identifier: MIT
/// Takes what a connecting stage emits for a batch to the buckets of a forest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pointsweep/connect/edge_buckets.h"
#include "pointsweep/operators/kinds/connect_operator.h"

namespace pointsweep {

struct Batch;

/// The edge emitter of one thread. It owns the memory that is reused from batch to batch, so it is not thread-safe.
class EdgeEmitter {
 public:
  explicit EdgeEmitter(EdgeBuckets& buckets) : buckets_(buckets) {}
  void take(const ConnectOperator& op, const Neighborhoods& in, const Batch& batch);

  /// Bytes that the edges to one neighbour take while the batch is worked on.
  static constexpr std::uint64_t bytes_per_neighbor(bool weighted) {
    constexpr std::uint64_t kGrowth = 2;  // capacity of a growing vector, as a multiple of its size
    return kGrowth * sizeof(NeighborEdge) + EdgeBatch::bytes_per_edge(weighted);
  }

 private:
  EdgeBuckets& buckets_;
  EdgeBatch graph_;
  std::vector<NeighborEdge> edges_;
  std::vector<std::byte> ballots_;
};

/// Number of points that a bucket should hold.
inline constexpr std::uint64_t kBucketPoints = 16384;

/// Returns the places where buckets begin: at each slab, at `places`, and inside a large slab so often that each bucket
/// holds about kBucketPoints if the points of the slab lie evenly along the axis.
std::vector<PointKey> bucket_begins(const class Stream& stream, std::span<const Vec3> places);

}  // namespace pointsweep
