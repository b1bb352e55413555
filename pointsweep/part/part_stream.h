// SPDX-License-Identifier: MIT
/// The stream of one tile of a cloud: its own points, those of other tiles that lie near them, and where all others
/// are.
#pragma once

#include <cstdint>

#include "pointsweep/neighborhood.h"
#include "pointsweep/order/stream.h"
#include "pointsweep/part/tile_reader.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {

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
