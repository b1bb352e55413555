// SPDX-License-Identifier: MIT
/// The stream of one tile of a cloud: its own points, those of other tiles that lie near them, and where all others
/// are.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pointsweep/neighborhood.h"
#include "pointsweep/order/stream.h"
#include "pointsweep/part/tile.h"
#include "pointsweep/storage/encoding.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {

/// Some slabs of a tile that follow each other.
struct TileRegion {
  std::uint32_t first_block = 0, end_block = 0;
  std::uint64_t count = 0;
  Box box;
  std::uint64_t least_row = 0;  ///< in the tile
};

/// What all machines know of a tile.
struct TileSummary {
  std::string name;             ///< of its objects in the scratch
  std::uint64_t first_row = 0;  ///< in the cloud, before which are the rows of the tiles before
  std::uint64_t rows = 0;
  std::vector<TileRegion> regions;  ///< all its points with a place; few
};

/// The tiles of a cloud when a pass has put their points in order.
struct TileCatalogue {
  std::vector<TileSummary> tiles;  ///< by number

  void encode(Encoder& out) const;
  static TileCatalogue decode(Decoder& in);
};

/// Reads the indices of the tiles, which stand in the order of the inputs. Throws Error where two of them have records
/// of different layouts; `paths` are the inputs, for the sentence.
TileCatalogue catalogue_of(const Storage& scratch, const std::vector<std::string>& names,
                           const std::vector<std::string>& paths);

/// A tile as a part of its cloud.
struct PartStream {
  Stream stream;                 ///< whose rows are those of the cloud; its axis is that of the tile
  Survey survey;                 ///< of the points of the tile
  std::uint64_t first_row = 0;   ///< of the tile
  std::uint64_t own_points = 0;  ///< with a place
  std::uint64_t swept_points = 0;
};

/// Returns the stream of tile `number`. A sweep of it with these neighbourhoods and steps has the results of a sweep of
/// the whole cloud for the points of the tile. `working`: Stream::record_schema() of the tile when it was stored. The
/// stream borrows the scratch.
PartStream part_stream(const Storage& scratch, const TileCatalogue& tiles, std::size_t number, const Schema& working,
                       const Neighborhood& what, std::size_t steps);

}  // namespace pointsweep
