// SPDX-License-Identifier: MIT
/// Points and edges in buckets along an axis, stored in the temporary folder until a forest is grown from them. The
/// bucket of an edge does not depend on the time at which the edge was found, so that a sweep may find edges in any
/// order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "pointsweep/connect/bucketed_graph.h"
#include "pointsweep/connect/edge_batch.h"
#include "pointsweep/connect/forest_edge.h"
#include "pointsweep/points/scratch.h"

namespace pointsweep {

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
  /// The place of a chunk in the scratch, where its points, ballots, marks and edges lie one after another.
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
