// SPDX-License-Identifier: MIT
/// Reads the points of the tiles of a cloud from the scratch.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/part/tile.h"
#include "pointsweep/storage/encoding.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {

/// Some blocks of a tile that follow each other, of which other tiles may have to know.
struct TileRegion {
  std::uint32_t first_block = 0, end_block = 0;
  std::uint64_t count = 0;
  Box box;
  std::uint64_t least_row = 0;  ///< in the tile
};

/// The facts about a tile that all machines know.
struct TileSummary {
  std::string name;             ///< of its objects in the scratch
  std::uint64_t first_row = 0;  ///< in the cloud, before which are the rows of the tiles before
  std::uint64_t rows = 0;
  std::vector<TileRegion> regions;  ///< all its points with a place, or those that it stored for others; few
};

/// The tiles of a cloud when a pass has put their points in order.
struct TileCatalogue {
  std::vector<TileSummary> tiles;  ///< by number

  /// Returns which tile has a row.
  std::size_t tile_of(std::uint64_t row) const;
  void encode(Encoder& out) const;
  static TileCatalogue decode(Decoder& in);
};

/// Reads the indices of the tiles, which stand in the order of the inputs. Throws Error where two of them have records
/// of different layouts; `paths` are the inputs, for the sentence.
TileCatalogue catalogue_of(const Storage& scratch, const std::vector<std::string>& names,
                           const std::vector<std::string>& paths);

/// Successive blocks of a tile.
struct BlockRange {
  std::uint32_t first, end;
};

/// Reads blocks of tiles. Thread-safe. Borrows the scratch and the catalogue.
class TileReader {
 public:
  /// `record_bytes`: of the records, which must be those of all tiles.
  TileReader(const Storage& scratch, const TileCatalogue& tiles, std::uint32_t record_bytes)
      : scratch_(scratch), tiles_(tiles), record_bytes_(record_bytes) {}

  /// The index of a tile, which is read once.
  const TileIndex& index(std::size_t tile) { return opened(tile).index; }
  /// Returns the points of the blocks of a tile before this one.
  std::uint64_t points_before(std::size_t tile, std::uint32_t block) { return opened(tile).first[block]; }

  /// Fills `out` with the records of the blocks of a tile; their rows become those of the cloud.
  void read(std::size_t tile, std::span<const BlockRange> ranges, std::span<std::byte> out);
  /// Fills `out` with records of points without a place.
  void read_nonfinite(std::size_t tile, std::uint64_t first, std::span<std::byte> out);

 private:
  struct Opened {
    TileIndex index;
    std::unique_ptr<Source> points;
    std::vector<std::uint64_t> first;  ///< by block: its first record, and the end of the last one
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
