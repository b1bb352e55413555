// SPDX-License-Identifier: MIT
/// A tile of a cloud in the scratch of a run on many machines: its points in blocks, of which other tiles read those
/// that lie near them (docs/adr/0021).
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/neighborhood.h"
#include "pointsweep/order/stream.h"
#include "pointsweep/order/survey.h"
#include "pointsweep/storage/encoding.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {

/// Points of a slab of a tile that lie close together. Their records follow each other.
struct TileBlock {
  std::uint64_t count = 0;
  Box box;
  std::uint64_t least_row = 0;  ///< in the tile; no row in the block is below
  std::uint64_t checksum = 0;   ///< of the records
};

/// What is known of the points of a tile in the scratch. Two objects hold them: NAME.points the records, slab by slab,
/// then copies of those that other tiles have to know, if they need not know all, and behind them those without a
/// place; NAME.index this value.
struct TileIndex {
  /// The records as text: two tiles with the same text have records that one run can read.
  std::string layout;
  std::uint32_t record_bytes = 0;
  std::uint64_t rows = 0;       ///< all of the tile
  std::uint64_t nonfinite = 0;  ///< rows without a place, which are in no block
  std::uint64_t nonfinite_checksum = 0;
  Survey survey;
  std::vector<TileBlock> blocks;
  std::vector<std::uint32_t> slab_ends;  ///< by slab: the number of blocks up to its end
  bool for_others = false;  ///< blocks after those of the slabs hold what other tiles have to know, and else all do

  /// Returns the number of blocks of the slabs, which are the first ones.
  std::uint32_t own_blocks() const { return slab_ends.empty() ? 0 : slab_ends.back(); }

  void encode(Encoder& out) const;
  static TileIndex decode(Decoder& in);
};

/// Returns the schema of the records in the scratch for working records of `working`: the position in float64, whatever
/// grid a tile has, the other fields, and the row in 64 bits.
Schema schema_in_scratch(const Schema& working);

/// Returns the numbers of those of some working records that other tiles have to know. Called from many threads at
/// once.
using ChooseForOthers = std::function<std::vector<std::uint32_t>(std::span<const std::byte> records)>;

/// Stores the points of a tile, whose rows count from 0, under `name`. `survey`: of its points. `choose`: empty where
/// other tiles have to know all of them. On all threads. Throws Error where the storage fails.
TileIndex store_tile(const Stream& stream, const Survey& survey, std::uint64_t rows, Storage& scratch,
                     const std::string& name, const ChooseForOthers& choose = {});

/// Stores a tile that has no rows under `name`.
void store_no_points(Storage& scratch, const std::string& name);

/// Reads an index. Throws Error where it is damaged.
TileIndex tile_index(const Storage& scratch, const std::string& name);

/// Returns how far the neighbourhoods of most points reach, estimated from the densities of the blocks.
double expected_reach(const TileIndex& tile, const Neighborhood& what);

/// Returns the box that holds all points of a tile but for about a thousandth at either end of each axis.
Box box_of_most(const TileIndex& tile);

}  // namespace pointsweep
