// SPDX-License-Identifier: MIT
/// Points and edges on their way to a forest, in the temporary folder: in buckets along an axis.
///
/// A point belongs to the bucket of its key. An edge lies in the bucket of its later end; if the other end is in an
/// earlier bucket, a mark there says until which bucket that point has edges. So when buckets are read in their order,
/// a point closes with its own bucket or the last that its marks name. It does not matter when an edge was found: the
/// edges of points that were deferred for long come into the same buckets as if found earlier.
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
#include "pointsweep/points/scratch.h"

namespace pointsweep {

/// `row`, of this bucket or an earlier one, has edges until the bucket `last`.
struct OpenUntil {
  std::uint64_t row;
  std::uint64_t last;
};

class EdgeBuckets final : public EdgeSink {
 public:
  /// `begins`: the keys at which all buckets except the first begin, in any order. If not `weighted`, only the rows of
  /// an edge are kept.
  EdgeBuckets(std::vector<PointKey> begins, int axis, bool weighted, std::size_t ballot_bytes,
              const MakeScratch& make_scratch);

  void put(const EdgeBatch& batch, std::size_t own, std::span<const std::byte> ballots) override;

  /// Some points, edges and marks of one bucket.
  struct Chunk {
    std::vector<PointKey> points;
    std::vector<std::byte> ballots;
    std::vector<ForestEdge> edges;
    std::vector<OpenUntil> marks;
  };
  std::size_t buckets() const { return places_.size(); }
  /// Returns the number of chunks of a bucket.
  std::size_t chunks(std::size_t bucket) const { return places_[bucket].size(); }
  void read(std::size_t bucket, std::size_t chunk, Chunk& out) const;

  bool weighted() const override { return weighted_; }
  std::uint64_t bytes() const { return bytes_; }

 private:
  /// The place of a chunk in the scratch, where its points, ballots, edges and marks lie one after another.
  struct Place {
    std::uint64_t offset;
    std::uint32_t points, edges, marks;
  };
  std::size_t bucket_of(const PointKey& point) const;
  void put(std::size_t bucket, const Chunk& chunk);
  std::size_t edge_bytes() const { return weighted_ ? sizeof(ForestEdge) : 2 * sizeof(std::uint64_t); }

  int axis_;
  bool weighted_;
  std::size_t ballot_bytes_;
  std::vector<PointKey> begins_;
  std::unique_ptr<Scratch> scratch_;
  std::mutex mutex_;
  std::vector<std::vector<Place>> places_;  ///< by bucket
  std::uint64_t bytes_ = 0;
};

}  // namespace pointsweep
