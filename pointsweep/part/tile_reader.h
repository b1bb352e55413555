// SPDX-License-Identifier: MIT
/// Reads the points of the tiles of a cloud from the scratch.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "pointsweep/part/tile.h"
#include "pointsweep/part/tile_catalogue.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {

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
    std::vector<std::uint64_t> first;  ///< number of the first record of each block, then the number of all records
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
