// SPDX-License-Identifier: MIT
/// Takes what a connecting stage emits for a batch to the buckets of a forest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pointsweep/connect/edge_buckets.h"
#include "pointsweep/operators/connect_operator.h"

namespace pointsweep {

struct Batch;

/// Of one thread.
class EdgeEmitter {
 public:
  explicit EdgeEmitter(EdgeBuckets& buckets) : buckets_(buckets) {}
  void take(const ConnectOperator& op, const Neighborhoods& in, const Batch& batch);

  /// What the edges of a neighbour take in memory while the batch is in hand.
  static constexpr std::uint64_t bytes_per_neighbor(bool weighted) {
    constexpr std::uint64_t kGrowth = 2;  // of vectors
    return kGrowth * sizeof(NeighborEdge) + EdgeBatch::bytes_per_edge(weighted);
  }

 private:
  EdgeBuckets& buckets_;
  EdgeBatch graph_;
  std::vector<NeighborEdge> edges_;
  std::vector<std::byte> ballots_;
};

/// Points of a bucket, by and large.
inline constexpr std::uint64_t kBucketPoints = 16384;

/// Where buckets begin: with each slab, in a large one so often that they hold about kBucketPoints if its points lie
/// evenly along the axis, and at `places`.
std::vector<PointKey> bucket_begins(const class Stream& stream, std::span<const Vec3> places);

}  // namespace pointsweep
