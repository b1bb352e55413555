// SPDX-License-Identifier: MIT
/// The catalogue of the tiles of a cloud, which every process of a run on many machines reads, the overlap of the boxes
/// of tiles, and the reading of their points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/math/box.h"
#include "pointsweep/part/tile.h"
#include "pointsweep/storage/encoding.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {

/// Successive blocks of a tile whose points other tiles may have to know.
struct TileRegion {
  std::uint32_t first_block = 0, end_block = 0;
  std::uint64_t count = 0;
  Box box;
  std::uint64_t least_row = 0;  ///< least row of a point of the region, counted in the tile
};

/// The facts about a tile that every process of the run reads.
struct TileSummary {
  std::string name;             ///< prefix of the keys of the tile's objects in the scratch (tile.h)
  std::uint64_t first_row = 0;  ///< first row of the tile in the cloud: the number of rows of all earlier tiles
  std::uint64_t rows = 0;
  std::vector<TileRegion> regions;  ///< at most 16 regions, which hold the points that other tiles may have to know
};

/// Small tiles that lie close together, or a single tile of any size. part_stream() makes one slab of a distant group.
/// In a cloud of 10,000 tiles, groups save most of the time of part_stream().
struct TileGroup {
  std::vector<std::uint32_t> tiles;  ///< numbers of the tiles, at most 32
  std::uint64_t count = 0;           ///< number of points in the regions, at most 65,536 in a group of several tiles
  Box box;                           ///< box of the regions
};

/// The catalogue of all tiles of a cloud, made after each tile has stored its points.
struct TileCatalogue {
  std::vector<TileSummary> tiles;  ///< tiles in the order of their numbers
  /// All tiles that have regions, in groups. Groups are not stored, since the tiles determine them.
  std::vector<TileGroup> groups = {};

  /// Returns the number of the tile that holds a row of the cloud. Throws Error if no tile holds it.
  std::size_t tile_of(std::uint64_t row) const;
  void encode(Encoder& out) const;
  static TileCatalogue decode(Decoder& in);
};

/// Makes the catalogue from the indices of the tiles with these names, in the order of the inputs. Throws Error if two
/// tiles that have rows have records of different layouts; `paths` are the names of the inputs in the message.
TileCatalogue catalogue_of(const Storage& scratch, const std::vector<std::string>& names,
                           const std::vector<std::string>& paths);

/// Returns the catalogue that seal_bytes() has stored under `key`. Many tasks of a process read the same catalogue, so
/// the process keeps the two catalogues that were used last and does not decode a kept one again. Catalogues count as
/// equal if their objects have the same size and checksum. Thread-safe. Throws Error like sealed_value().
std::shared_ptr<const TileCatalogue> shared_catalogue(const Storage& scratch, const std::string& key);

/// The box of a tile, which may be empty, and the number of points of the tile.
struct TileExtent {
  Box box;
  std::uint64_t points = 0;
};

/// Returns the mean number of tile boxes that contain a point: 1 for tiles side by side. Assumes that the points of a
/// tile are spread evenly over its box. Cost: some nanoseconds for each pair of tiles.
double mean_tiles_of_a_point(std::span<const TileExtent> tiles);

/// Successive blocks of a tile.
struct TileBlocks {
  std::uint32_t tile;
  std::uint32_t first, end;
};

/// Reads blocks of tiles. Thread-safe. Borrows the scratch and the catalogue.
class TileReader {
 public:
  /// `record_bytes`: bytes of a record, equal for all tiles.
  TileReader(const Storage& scratch, const TileCatalogue& tiles, std::uint32_t record_bytes)
      : scratch_(scratch), tiles_(tiles), record_bytes_(record_bytes) {}

  /// Returns the index of a tile, which is read from the scratch once.
  const TileIndex& index(std::size_t tile) { return opened(tile).index; }
  /// Returns the number of points in the blocks of a tile before `block`.
  std::uint64_t points_before(std::size_t tile, std::uint32_t block) { return opened(tile).first[block]; }

  /// Fills `out` with the records of the blocks `all`, one after another, and converts their rows into rows of the
  /// cloud. Throws Error if a checksum is wrong or a tile belongs to another run.
  void read(std::span<const TileBlocks> all, std::span<std::byte> out);
  /// Fills `out` with records of points with non-finite coordinates, from number `first` of these points on. Throws
  /// Error like read().
  void read_nonfinite(std::size_t tile, std::uint64_t first, std::span<std::byte> out);

 private:
  struct Opened {
    TileIndex index;
    std::unique_ptr<Source> points;
    /// Number of the first record of each block, then the number of records of all blocks.
    std::vector<std::uint64_t> first;
  };
  const Opened& opened(std::size_t tile);
  void require_whole(std::size_t tile, std::span<const std::byte> records, std::uint64_t checksum) const;
  void number(std::size_t tile, std::span<std::byte> records) const;

  const Storage& scratch_;
  const TileCatalogue& tiles_;
  std::uint32_t record_bytes_;
  std::mutex mutex_;
  std::map<std::size_t, std::unique_ptr<Opened>> opened_;
};

}  // namespace pointsweep
