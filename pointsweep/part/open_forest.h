// SPDX-License-Identifier: MIT
/// Encodings of a tile's border and of a spanning forest with open points. spanning_forest.h explains open points and
/// supernodes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pointsweep/connect/forest_edge.h"
#include "pointsweep/connect/spanning_forest.h"
#include "pointsweep/storage/encoding.h"

namespace pointsweep {

/// The border of a tile: its points at which edges between tiles end, and the edges between it and earlier tiles.
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

}  // namespace pointsweep
