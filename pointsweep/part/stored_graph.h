// SPDX-License-Identifier: MIT
/// The points and edges of a tile, bucket by bucket, as objects from which its forest grows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pointsweep/connect/bucketed_graph.h"
#include "pointsweep/part/record_list.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {

/// Leaves four lists: NAME.nodes, the points with their ballots, NAME.edges, NAME.marks, and NAME.buckets, how many of
/// each are in a bucket.
void store_graph(const BucketedGraph& graph, std::size_t ballot_bytes, Storage& scratch, const std::string& name);

class StoredGraph final : public BucketedGraph {
 public:
  /// Throws Error, which calls an object damaged, where the lists do not go together.
  StoredGraph(const Storage& scratch, const std::string& name, std::size_t ballot_bytes);
  std::size_t buckets() const override { return buckets_.size(); }
  std::size_t chunks(std::size_t bucket) const override;
  void read_points(std::size_t bucket, std::size_t chunk, Points& out) const override;
  void read_edges(std::size_t bucket, std::size_t chunk, std::vector<ForestEdge>& out) const override;

  /// The numbers of points, edges and marks in a part of the graph.
  struct Counts {
    std::uint64_t points = 0, edges = 0, marks = 0;
  };

 private:
  struct Bucket {
    Counts first, count;
  };

  std::size_t ballot_bytes_;
  RecordList nodes_, edges_, marks_;
  std::vector<Bucket> buckets_;
};

}  // namespace pointsweep
