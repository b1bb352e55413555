// SPDX-License-Identifier: MIT
/// The stream of one tile of a cloud: the points of the tile, points of other tiles near it (the halo), and the places
/// of all other points, which only the recall of the sweep reads.
#pragma once

#include <cstdint>

#include "pointsweep/neighborhood.h"
#include "pointsweep/order/stream.h"
#include "pointsweep/part/tile_reader.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {

/// A tile as a part of its cloud.
struct PartStream {
  Stream stream;                   ///< stream with rows of the cloud, along the axis of the tile's survey
  Survey survey;                   ///< survey of the points of the tile
  std::uint64_t first_row = 0;     ///< first row of the tile in the cloud
  std::uint64_t own_points = 0;    ///< points of the tile with finite coordinates
  std::uint64_t swept_points = 0;  ///< points of the tile and its halo
};

/// Returns the stream of tile `number`. For the points of the tile, a sweep over this stream has the results of a sweep
/// over the whole cloud. `what` and `steps`, the neighbourhood and number of steps of that sweep, set the width of the
/// halo. `working`: Stream::record_schema() of the tile when it was stored. The stream borrows the scratch.
PartStream part_stream(const Storage& scratch, const TileCatalogue& tiles, std::size_t number, const Schema& working,
                       const Neighborhood& what, std::size_t steps);

}  // namespace pointsweep
