// SPDX-License-Identifier: MIT
/// Takes what a connecting stage emits for a batch to the buckets of a forest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pointsweep/connect/edge_buckets.h"
#include "pointsweep/operators/connecting_operator.h"

namespace pointsweep {

struct Batch;

/// Of one thread.
class EdgeEmitter {
 public:
  explicit EdgeEmitter(EdgeBuckets& buckets) : buckets_(buckets) {}
  void take(const ConnectingOperator& op, const Neighborhoods& in, const Batch& batch);

 private:
  EdgeBuckets& buckets_;
  EdgeBatch graph_;
  std::vector<NeighborEdge> edges_;
  std::vector<std::byte> ballots_;
};

/// Points of a bucket, by and large.
inline constexpr std::uint64_t kBucketPoints = 16384;

/// Where buckets begin: with each slab, and in a large one so often that they hold about kBucketPoints.
std::vector<PointKey> bucket_begins(const class Stream& stream);

}  // namespace pointsweep
