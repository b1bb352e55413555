// SPDX-License-Identifier: MIT
/// The encodings of the border of a tile and of a forest with open points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pointsweep/connect/forest_edge.h"
#include "pointsweep/connect/spanning_forest.h"
#include "pointsweep/storage/encoding.h"

namespace pointsweep {

/// The points of a tile that edges between tiles name, and such edges.
struct TileBorder {
  struct Point {
    std::uint64_t row;
    std::uint64_t last;  ///< number of the last tile among its own and those to which its edges lead
  };
  std::vector<Point> points;      ///< ascending by row
  std::vector<ForestEdge> edges;  ///< to points of earlier tiles

  void encode(Encoder& out) const;
  static TileBorder decode(Decoder& in);
};

/// A forest as an encoded value.
void encode(Encoder& out, const OpenForest& forest);
/// Throws Error where supernodes are named that are not there, or have votes of another size.
OpenForest decode_open_forest(Decoder& in, std::size_t vote_bytes);

}  // namespace pointsweep
