// SPDX-License-Identifier: MIT
/// The stream of one tile of a cloud. It contains the points of the tile, points of other tiles near it (the halo), and
/// all other points of the cloud with finite coordinates, which only the recall (sweep/recall.h) reads.
#pragma once

#include <cstdint>

#include "pointsweep/neighborhood.h"
#include "pointsweep/order/stream.h"
#include "pointsweep/part/tile_catalogue.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {

/// A tile as a part of its cloud.
struct PartStream {
  Stream stream;                   ///< stream with row numbers of the cloud, along the axis of the tile's survey
  Survey survey;                   ///< survey of the points of the tile
  std::uint64_t first_row = 0;     ///< first row of the tile in the cloud
  std::uint64_t own_points = 0;    ///< points of the tile with finite coordinates
  std::uint64_t swept_points = 0;  ///< points of the tile and its halo
};

/// Returns the stream of tile `number`. A sweep over this stream gives the points of the tile the same results as a
/// sweep over the whole cloud. `what` and `steps` are the neighbourhood and the number of steps of the sweep; they set
/// the width of the halo. `working`: Stream::record_schema() of the tile when it was stored. The stream borrows
/// `scratch` and `tiles`.
PartStream part_stream(const Storage& scratch, const TileCatalogue& tiles, std::size_t number, const Schema& working,
                       const Neighborhood& what, std::size_t steps);

}  // namespace pointsweep
