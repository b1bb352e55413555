// SPDX-License-Identifier: MIT
#include "pointsweep/formats/parallel_rows.h"

#include <algorithm>

#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

/// Rows of a piece where any range is a chunk.
constexpr std::uint64_t kPieceRows = 16384;

}  // namespace

std::vector<ParallelRows::Piece> ParallelRows::pieces_of(const InputCloud& cloud, std::uint64_t row,
                                                         std::uint64_t end) {
  std::vector<Piece> pieces;
  while (row < end) {
    std::uint64_t chunk_end = cloud.chunk_end(row);
    if (chunk_end == row) chunk_end = row + kPieceRows;
    pieces.push_back({row, std::min(chunk_end, end), next_});
    if (chunk_end <= end) next_ = (next_ + 1) % decoders_.size();
    row = pieces.back().end;
  }
  return pieces;
}

std::size_t ParallelRows::read(InputCloud& cloud, std::uint64_t row, std::span<std::byte> records) {
  if (decoders_.empty()) {
    decoders_.resize(thread_count());
    for (auto& decoder : decoders_) decoder = cloud.decoder();
  }
  if (!decoders_.front()) return cloud.read(row, records);
  const std::size_t stride = cloud.schema().stride;
  const std::uint64_t end = std::min<std::uint64_t>(cloud.count(), row + records.size() / stride);
  const std::vector<Piece> pieces = pieces_of(cloud, row, end);
  parallel_for(decoders_.size(), [&](std::size_t d, unsigned) {
    for (const Piece& piece : pieces)
      if (piece.decoder == d)
        decoders_[d]->read(piece.row, records.subspan((piece.row - row) * stride, (piece.end - piece.row) * stride));
  });
  return static_cast<std::size_t>(row < end ? end - row : 0);
}

}  // namespace pointsweep
