// SPDX-License-Identifier: MIT
/// A tile of a cloud in the scratch, the storage that all processes of a run on many machines share. Its points are
/// stored in blocks, and other tiles read the blocks near them (docs/adr/0021).
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

/// A block: points of one slab of a tile that lie close together and whose records follow each other.
struct TileBlock {
  std::uint64_t count = 0;
  Box box;
  std::uint64_t least_row = 0;  ///< least row among the points of the block, counted in the tile
  std::uint64_t checksum = 0;   ///< checksum of the records of the block
};

/// Most points with non-finite coordinates that are stored and read at once.
inline constexpr std::uint64_t kNonfiniteAtOnce = 1 << 14;

/// The index of a tile that is stored under NAME, in the object NAME.index. The object NAME.points holds the records:
/// slab by slab, then copies of the points that other tiles have to know (unless other tiles have to know all points),
/// then the points with non-finite coordinates.
struct TileIndex {
  /// The layout of the records as text. Tiles with equal texts have records that one run can read.
  std::string layout;
  std::uint32_t record_bytes = 0;
  std::uint64_t rows = 0;       ///< number of all points of the tile
  std::uint64_t nonfinite = 0;  ///< number of points with non-finite coordinates, which are in no block
  /// Checksums of the records of points with non-finite coordinates, one for each kNonfiniteAtOnce points; the last
  /// checksum may cover fewer points.
  std::vector<std::uint64_t> nonfinite_checksums;
  Survey survey;
  std::vector<TileBlock> blocks;
  std::vector<std::uint32_t> slab_ends;  ///< for each slab, the number of blocks up to its end
  /// True if the blocks after the slabs hold copies of the points that other tiles have to know; false if other tiles
  /// have to know all points.
  bool for_others = false;

  /// Returns the number of blocks of the slabs, which stand first in `blocks`.
  std::uint32_t own_blocks() const { return slab_ends.empty() ? 0 : slab_ends.back(); }

  void encode(Encoder& out) const;
  static TileIndex decode(Decoder& in);
};

/// Returns the schema of the records in the scratch for stream records of schema `working`: the position as 3×f64, so
/// that it does not depend on the coordinate grid of a tile; the other fields; the row as u64.
Schema schema_in_scratch(const Schema& working);

/// A function that returns the indices, in `records`, of the records that other tiles have to know. Must be
/// thread-safe.
using ChooseForOthers = std::function<std::vector<std::uint32_t>(std::span<const std::byte> records)>;

/// Stores the points of a tile, whose rows count from 0, under `name`, on all threads. `survey`: survey of the points.
/// `choose`: empty if other tiles have to know all points. Throws Error if the storage fails.
TileIndex store_tile(const Stream& stream, const Survey& survey, std::uint64_t rows, Storage& scratch,
                     const std::string& name, const ChooseForOthers& choose = {});

/// Stores a tile that has no rows under `name`.
void store_no_points(Storage& scratch, const std::string& name);

/// Reads the index of the tile stored under `name`. Throws Error if the index is damaged.
TileIndex tile_index(const Storage& scratch, const std::string& name);

/// Returns the distance within which the neighbourhoods of most points of the tile end, estimated from the densities of
/// the blocks.
double expected_reach(const TileIndex& tile, const Neighborhood& what);

/// Returns a box of the points of a tile that leaves out at most a thousandth of them at either end of each axis.
Box box_of_most(const TileIndex& tile);

}  // namespace pointsweep
