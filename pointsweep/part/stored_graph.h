// SPDX-License-Identifier: MIT
/// The points and edges of a tile, bucket by bucket, as objects of a storage, from which the tile's forest is grown.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pointsweep/connect/bucketed_graph.h"
#include "pointsweep/part/record_list.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {

/// Stores a graph as four lists: NAME.nodes, its points with their ballots (the values from which votes are made);
/// NAME.edges; NAME.marks, the OpenUntil marks; NAME.buckets, the numbers of nodes, edges and marks of each bucket.
void store_graph(const BucketedGraph& graph, std::size_t ballot_bytes, Storage& scratch, const std::string& name);

class StoredGraph final : public BucketedGraph {
 public:
  /// Opens a stored graph. Throws Error, which calls an object damaged, if the lengths of its lists disagree.
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
