// SPDX-License-Identifier: MIT
/// The objects of a storage that hold the weighted graph of a tile: the points and edges, bucket by bucket, from which
/// the tile's forest is grown; the border of the tile; and the spanning forest whose points at the border are open.
/// spanning_forest.h explains open points and supernodes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pointsweep/connect/bucketed_graph.h"
#include "pointsweep/connect/forest_edge.h"
#include "pointsweep/connect/spanning_forest.h"
#include "pointsweep/part/record_list.h"
#include "pointsweep/storage/encoding.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {

/// The border of a tile: its points at which edges between tiles end, and the edges between this tile and earlier
/// tiles.
struct TileBorder {
  struct Point {
    std::uint64_t row;
    std::uint64_t last;  ///< number of the last tile among the tile of the point and the tiles to which its edges lead
  };
  std::vector<Point> points;      ///< points at which edges between tiles end, ascending by row
  std::vector<ForestEdge> edges;  ///< edges between this tile and earlier tiles

  void encode(Encoder& out) const;
  static TileBorder decode(Decoder& in);
};

/// Appends the encoded forest to `out`.
void encode(Encoder& out, const OpenForest& forest);
/// Reads a forest. Throws Error if the forest names a supernode that it does not hold, or if the votes of a supernode
/// do not have `vote_bytes` bytes.
OpenForest decode_open_forest(Decoder& in, std::size_t vote_bytes);

/// Stores a graph as four lists: NAME.nodes, its points with their ballots (the values from which votes are made);
/// NAME.edges; NAME.marks, for each mark the last bucket with edges of a point (OpenUntil); NAME.buckets, the numbers
/// of nodes, edges and marks of each bucket.
void store_graph(const BucketedGraph& graph, std::size_t ballot_bytes, Storage& scratch, const std::string& name);

/// A graph that store_graph() has stored.
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
