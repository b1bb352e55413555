// SPDX-License-Identifier: MIT
#include "pointsweep/order/source.h"

#include <algorithm>

#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kLeastPieceRows = 1024;  ///< least rows of a piece if the source may be split at any row

}  // namespace

void read_fully(const PointSource& source, std::uint64_t row, std::span<std::byte> records) {
  read_fully(source, source.read, row, records);
}

void read_fully(const PointSource& source, const ReadRows& read, std::uint64_t row, std::span<std::byte> records) {
  while (!records.empty()) {
    const std::size_t got = read(row, records);
    if (got == 0)
      fail(
          "the input ends at point {} though it holds {}: it was cut short while it was read; run again on the "
          "complete input.",
          row, source.count);
    row += got;
    records = records.subspan(got * source.schema.stride);
  }
}

std::vector<std::size_t> position_columns(const Schema& schema) {
  std::vector<std::size_t> columns;
  for (const char* axis : {"x", "y", "z"})
    if (const auto field = schema.find(axis)) columns.push_back(*field);
  return columns;
}

BlockReader::BlockReader(const PointSource& source, const std::vector<std::size_t>& wanted)
    : source_(source), fields_(position_fields(source.schema, "the input")), read_(source.for_thread(wanted)) {}

void BlockReader::read(std::uint64_t first_row, std::size_t rows) {
  const std::size_t stride = source_.schema.stride;
  count_ = rows;
  records_.resize(std::max(records_.size(), rows * stride));
  numbers_.resize(std::max(numbers_.size(), 3 * rows));
  read_fully(source_, read_, first_row, std::span(records_).first(rows * stride));
  double* const x = numbers_.data();
  decode_positions(fields_, records_.data(), stride, rows, x, x + rows, x + 2 * rows);
}

std::vector<ParallelRows::Piece> ParallelRows::pieces_of(std::uint64_t row, std::uint64_t end) {
  const std::uint64_t share = std::max(kLeastPieceRows, (end - row + readers_.size() - 1) / readers_.size());
  std::vector<Piece> pieces;
  while (row < end) {
    std::uint64_t chunk_end = source_.chunk_end ? source_.chunk_end(row) : row;
    if (chunk_end == row) chunk_end = row + share;
    pieces.push_back({row, std::min(chunk_end, end), next_});
    if (chunk_end <= end) next_ = (next_ + 1) % readers_.size();
    row = pieces.back().end;
  }
  return pieces;
}

bool ParallelRows::is_parallel() {
  if (readers_.empty()) {
    readers_.resize(source_.for_thread ? thread_count() : 1);
    for (ReadRows& reader : readers_)
      if (source_.for_thread) reader = source_.for_thread({});
  }
  return readers_.front() != nullptr;
}

void ParallelRows::read(std::uint64_t row, std::span<std::byte> records) {
  if (!is_parallel()) return read_fully(source_, row, records);
  const std::size_t stride = source_.schema.stride;
  const std::vector<Piece> pieces = pieces_of(row, row + records.size() / stride);
  FirstFailure failure;
  parallel_for(readers_.size(), [&](std::size_t r, unsigned) {
    for (const Piece& piece : pieces) {
      if (piece.reader != r || failure.makes_needless(piece.row)) continue;
      failure.note_from(piece.row, [&] {
        read_fully(source_, readers_[r], piece.row,
                   records.subspan((piece.row - row) * stride, (piece.end - piece.row) * stride));
      });
    }
  });
  failure.rethrow();
}

std::size_t rows_at_once(std::size_t bytes) {
  constexpr std::size_t kOfThread = 256 << 10, kLeast = 1 << 20, kMost = 4 << 20;
  const std::size_t all = std::clamp(thread_count() * kOfThread, kLeast, kMost);
  return std::max<std::size_t>(1, all / std::max<std::size_t>(bytes, 1));
}

}  // namespace pointsweep
