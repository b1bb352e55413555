// SPDX-License-Identifier: MIT
#include "pointsweep/part/tile_reader.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "pointsweep/fail.h"

namespace pointsweep {

void TileReader::read(std::span<const TileBlocks> all, std::span<std::byte> out) {
  for (const TileBlocks& blocks : all) {
    const Opened& tile = opened(blocks.tile);
    if (blocks.end > tile.index.blocks.size()) fail("{}.index: is of another run.", tiles_.tiles[blocks.tile].name);
    const std::uint64_t first = tile.first[blocks.first], count = tile.first[blocks.end] - first;
    const std::span<std::byte> records = out.first(count * record_bytes_);
    tile.points->read_at(first * record_bytes_, records);
    for (std::uint32_t b = blocks.first; b < blocks.end; ++b) {
      const std::size_t at = (tile.first[b] - first) * record_bytes_;
      require_whole(blocks.tile, records.subspan(at, tile.index.blocks[b].count * record_bytes_),
                    tile.index.blocks[b].checksum);
    }
    number(blocks.tile, records);
    out = out.subspan(records.size());
  }
}

void TileReader::read_nonfinite(std::size_t tile, std::uint64_t first, std::span<std::byte> out) {
  const Opened& from = opened(tile);
  const std::uint64_t end = first + out.size() / record_bytes_;
  std::vector<std::byte> piece;
  for (std::uint64_t p = first / kNonfiniteAtOnce; p * kNonfiniteAtOnce < end; ++p) {
    const std::uint64_t begin = p * kNonfiniteAtOnce;
    piece.resize(std::min(kNonfiniteAtOnce, from.index.nonfinite - begin) * record_bytes_);
    from.points->read_at((from.first.back() + begin) * record_bytes_, piece);
    require_whole(tile, piece, from.index.nonfinite_checksums[p]);
    const std::uint64_t from_row = std::max(first, begin), to_row = std::min(end, begin + kNonfiniteAtOnce);
    std::copy_n(piece.data() + (from_row - begin) * record_bytes_, (to_row - from_row) * record_bytes_,
                out.data() + (from_row - first) * record_bytes_);
  }
  number(tile, out);
}

const TileReader::Opened& TileReader::opened(std::size_t tile) {
  const std::scoped_lock lock(mutex_);
  std::unique_ptr<Opened>& place = opened_[tile];
  if (place) return *place;
  const std::string& name = tiles_.tiles[tile].name;
  auto found = std::make_unique<Opened>(Opened{tile_index(scratch_, name), scratch_.open(name + ".points"), {0}});
  for (const TileBlock& block : found->index.blocks) found->first.push_back(found->first.back() + block.count);
  const bool has_none = found->index.rows == 0;  // a tile without rows has no layout of records either
  if ((found->index.record_bytes != record_bytes_ && !has_none) || found->index.rows != tiles_.tiles[tile].rows)
    fail("{}.index: is of another run.", name);
  place = std::move(found);
  return *place;
}

void TileReader::require_whole(std::size_t tile, std::span<const std::byte> records, std::uint64_t checksum) const {
  if (checksum_of(records) != checksum) fail("{}.points: is damaged.", tiles_.tiles[tile].name);
}

/// Converts rows of the tile into rows of the cloud. The row is the last field of a record, as u64.
void TileReader::number(std::size_t tile, std::span<std::byte> records) const {
  std::byte* row_at = records.data() + record_bytes_ - sizeof(std::uint64_t);
  for (std::size_t i = 0; i < records.size() / record_bytes_; ++i, row_at += record_bytes_) {
    std::uint64_t row;
    std::memcpy(&row, row_at, sizeof row);
    row += tiles_.tiles[tile].first_row;
    std::memcpy(row_at, &row, sizeof row);
  }
}

}  // namespace pointsweep
