// SPDX-License-Identifier: MIT
#include "pointsweep/formats/cloud/reader_adapters.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/points/input_row.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

bool can_be_nonfinite(const Field& field) {
  if (field.type == Type::f32 || field.type == Type::f64) return true;
  return !std::isfinite(0x1p64 * field.scale + field.bias);
}

void read_all_of(const FileInfo& info, const ReadInputRows& read, std::uint64_t row, std::span<std::byte> records) {
  while (!records.empty()) {
    const std::size_t n = read(row, records);
    if (n == 0) fail("{}: ends before its last point; run again when it is complete.", info.path.string());
    records = records.subspan(n * info.schema.stride);
    row += n;
  }
}

ReadInputRows reading_by(Reader& reader) {
  return [&reader](std::uint64_t row, std::span<std::byte> records) { return reader.read(row, records); };
}

/// Calls `use(i)` for every record of a block with a coordinate that is not finite. Extends `bounds` by all other
/// points.
template <class Use>
void for_each_nonfinite_record(const PositionFields& position, std::span<const std::byte> records, std::size_t stride,
                               Box& bounds, Use use) {
  constexpr std::size_t kMost = FiniteRowIndex::kBlock;
  static thread_local double x[kMost], y[kMost], z[kMost];
  const std::size_t n = records.size() / stride;
  decode_positions(position, records.data(), stride, n, x, y, z);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 p{x[i], y[i], z[i]};
    is_finite(p) ? bounds.include(p) : use(i);
  }
}

}  // namespace

bool can_be_nonfinite(const Schema& schema, const std::filesystem::path& path) {
  const PositionFields p = position_fields(schema, path.string());
  return can_be_nonfinite(p.x) || can_be_nonfinite(p.y) || can_be_nonfinite(p.z);
}

/// Successive blocks of an input that one thread reads, with their finite and nonfinite rows.
struct FiniteRowIndex::Piece {
  std::uint64_t first, end;           ///< range of rows, [first, end)
  std::vector<std::uint64_t> finite;  ///< number of finite rows in each block
  std::vector<std::uint64_t> others;  ///< the first nonfinite rows, at most kMostListed
  std::uint64_t count = 0;            ///< number of nonfinite rows
  Box bounds;
};

FiniteRowIndex::FiniteRowIndex(Reader& reader, std::uint64_t first_row, NonfiniteRows& found,
                               const std::function<void(std::uint64_t)>& progress)
    : rows_(reader.info().count), before_{0} {
  const FileInfo& info = reader.info();
  const std::size_t at_once = reader.has_decoders() ? 4 * thread_count() : 1;
  std::vector<std::unique_ptr<RowDecoder>> decoders(thread_count());
  for (std::uint64_t row = 0; row < rows_;) {
    std::vector<Piece> pieces;
    for (; row < rows_ && pieces.size() < at_once; row = pieces.back().end)
      pieces.push_back({row, end_of_piece(reader, row), {}, {}, 0, {}});
    parallel_for(pieces.size(), [&](std::size_t i, unsigned worker) {
      if (reader.has_decoders() && !decoders[worker]) decoders[worker] = reader.decoder();
      const ReadInputRows read = [&](std::uint64_t first, std::span<std::byte> records) {
        return decoders[worker] ? decoders[worker]->read(first, records) : reader.read(first, records);
      };
      look_at(info, read, pieces[i]);
    });
    for (const Piece& piece : pieces) {
      for (const std::uint64_t finite : piece.finite) before_.push_back(before_.back() + finite);
      if (found.count == 0 && piece.count > 0)
        found.first = fmt::format("row {} of {}", piece.others.front(), info.path.string());
      for (const std::uint64_t other : piece.others)
        if (found.rows.size() < NonfiniteRows::kMostListed) found.rows.push_back(first_row + other);
      found.count += piece.count;
      found.bounds.include(piece.bounds);
    }
    if (progress) progress(row);
  }
}

/// Returns the row after the piece that begins at `row`: all blocks that begin in the chunk of `row`, or a fixed number
/// of blocks.
std::uint64_t FiniteRowIndex::end_of_piece(const Reader& reader, std::uint64_t row) const {
  constexpr std::uint64_t kBlocks = 4;  // blocks of a piece, if rows may be split anywhere or one thread reads all
  if (!reader.has_decoders() || reader.decodes_any_range()) return std::min(rows_, row + kBlocks * kBlock);
  return std::min(rows_, (reader.chunk_of(row).end_row() + kBlock - 1) / kBlock * kBlock);
}

void FiniteRowIndex::look_at(const FileInfo& info, const ReadInputRows& read, Piece& piece) {
  const PositionFields position = position_fields(info.schema, info.path.string());
  std::vector<std::byte> records;
  for (std::uint64_t row = piece.first; row < piece.end; row += kBlock) {
    stop_if_cancelled();
    const std::uint64_t n = std::min(kBlock, piece.end - row);
    records.resize(n * info.schema.stride);
    read_all_of(info, read, row, records);
    std::uint64_t finite = n;
    for_each_nonfinite_record(position, records, info.schema.stride, piece.bounds, [&](std::size_t i) {
      --finite;
      ++piece.count;
      if (piece.others.size() < NonfiniteRows::kMostListed) piece.others.push_back(row + i);
    });
    piece.finite.push_back(finite);
  }
}

std::size_t FiniteRowIndex::block_of(std::uint64_t row) const {
  return static_cast<std::size_t>(std::upper_bound(before_.begin(), before_.end(), row) - before_.begin()) - 1;
}

/// Reads finite rows for one thread.
class FiniteRows::Decoder final : public RowDecoder {
 public:
  /// `read` reads rows of the input.
  Decoder(const FiniteRows& rows, ReadInputRows read) : rows_(rows), index_(rows.index_), read_(std::move(read)) {}

  std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
    const std::size_t stride = rows_.info_.schema.stride;
    const std::size_t wanted = rows_.rows_for(row, records);
    for (std::size_t done = 0; done < wanted;) {
      const std::size_t block = index_.block_of(row + done);
      const auto offset = static_cast<std::size_t>(row + done - index_.before(block));
      std::size_t end = block + 1;
      const auto gives = [&] { return static_cast<std::size_t>(index_.before(end) - row) - done; };
      const bool whole = index_.is_whole(block);
      while (whole && gives() < wanted - done && index_.is_whole(end)) ++end;
      const std::size_t n = std::min(wanted - done, gives());
      const auto target = records.subspan(done * stride, n * stride);
      if (whole) {
        read_all_of(rows_.all_->info(), read_, block * FiniteRowIndex::kBlock + offset, target);
      } else {
        load(block);
        std::memcpy(target.data(), block_.data() + offset * stride, target.size());
      }
      done += n;
    }
    return wanted;
  }

  std::uint64_t input_row(std::uint64_t row) {
    const std::size_t block = index_.block_of(row);
    std::uint64_t at = row - index_.before(block);
    if (!index_.is_whole(block)) {
      load(block);
      for (const std::size_t gap : gaps_) at += gap <= at ? 1 : 0;
    }
    return block * FiniteRowIndex::kBlock + at;
  }

 private:
  void load(std::size_t block) {
    if (block == loaded_) return;
    const std::size_t stride = rows_.info_.schema.stride;
    block_.resize(index_.rows_in(block) * stride);
    read_all_of(rows_.all_->info(), read_, block * FiniteRowIndex::kBlock, block_);
    gaps_.clear();
    Box ignored;
    for_each_nonfinite_record(rows_.position_, block_, stride, ignored, [&](std::size_t i) { gaps_.push_back(i); });
    std::size_t kept = 0, gap = 0;
    for (std::size_t i = 0; i * stride < block_.size(); ++i) {
      if (gap < gaps_.size() && gaps_[gap] == i) {
        ++gap;
        continue;
      }
      if (kept != i) std::memcpy(block_.data() + kept * stride, block_.data() + i * stride, stride);
      ++kept;
    }
    loaded_ = block;
  }

  const FiniteRows& rows_;
  const FiniteRowIndex& index_;
  ReadInputRows read_;
  std::size_t loaded_ = std::numeric_limits<std::size_t>::max();  ///< block whose finite rows `block_` holds
  std::vector<std::byte> block_;
  std::vector<std::size_t> gaps_;  ///< records of block `loaded_` that are left out, ascending
};

FiniteRows::FiniteRows(std::shared_ptr<Reader> all, FiniteRowIndex index)
    : all_(std::move(all)),
      index_(std::move(index)),
      position_(position_fields(all_->info().schema, all_->info().path.string())) {
  info_ = all_->info();
  info_.left_out += info_.count - index_.count();
  info_.count = index_.count();
  own_ = std::make_unique<Decoder>(*this, reading_by(*all_));
}

FiniteRows::~FiniteRows() = default;

std::size_t FiniteRows::first_block_from(std::uint64_t row) const {
  return std::min<std::size_t>((row + FiniteRowIndex::kBlock - 1) / FiniteRowIndex::kBlock, index_.blocks());
}

Chunk FiniteRows::chunk_of(std::uint64_t row) const {
  if (decodes_any_range()) return Reader::chunk_of(row);
  const Chunk all = all_->chunk_of(index_.block_of(row) * FiniteRowIndex::kBlock);
  const std::uint64_t begin = index_.before(first_block_from(all.first_row));
  return {begin, index_.before(first_block_from(all.end_row())) - begin, 0, 0, std::nullopt};
}

std::unique_ptr<RowDecoder> FiniteRows::decoder(const WantedFields& wanted) const {
  if (!has_decoders()) return nullptr;
  WantedFields with_positions = wanted;
  for (const char* axis : {"x", "y", "z"})
    if (!wanted.empty()) with_positions.push_back(info_.schema.find(axis).value());
  const std::shared_ptr<RowDecoder> all = all_->decoder(with_positions);
  return std::make_unique<Decoder>(
      *this, [all](std::uint64_t row, std::span<std::byte> records) { return all->read(row, records); });
}

std::size_t FiniteRows::read(std::uint64_t row, std::span<std::byte> records) { return own_->read(row, records); }

std::uint64_t FiniteRows::input_row(std::uint64_t row) { return own_->input_row(row); }

std::uint64_t FiniteRows::row_of_all(std::uint64_t row) const {
  const std::shared_ptr<RowDecoder> all = all_->decoder();
  if (!all) return own_->input_row(row);
  return Decoder(*this, [&](std::uint64_t first, std::span<std::byte> records) { return all->read(first, records); })
      .input_row(row);
}

NumberedRows::NumberedRows(std::shared_ptr<Reader> all, std::uint64_t first_row)
    : all_(std::move(all)), first_row_(first_row) {
  info_ = all_->info();
  info_.schema = with_input_row(info_.schema);
}

/// Reads the records without numbers into the end of `records`, and then moves each to its place before its number. No
/// move overwrites a record that has not been moved, since the place of a record ends before the next record begins.
template <class Read>
std::size_t NumberedRows::read_numbered(Read read, std::uint64_t row, std::span<std::byte> records) const {
  const std::size_t stride = info_.schema.stride, own = all_->info().schema.stride;
  const std::size_t most = rows_for(row, records);
  std::byte* const end = records.data() + most * (stride - own);
  const std::size_t rows = most == 0 ? 0 : read(row, std::span(end, most * own));
  for (std::size_t i = 0; i < rows; ++i) {
    std::byte* const record = records.data() + i * stride;
    std::memmove(record, end + i * own, own);
    const std::uint64_t number = first_row_ + row + i;
    std::memcpy(record + own, &number, sizeof number);
  }
  return rows;
}

class NumberedRows::Decoder final : public RowDecoder {
 public:
  Decoder(const NumberedRows& rows, std::unique_ptr<RowDecoder> own) : rows_(rows), own_(std::move(own)) {}

  std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
    return rows_.read_numbered([this](std::uint64_t first, auto own) { return own_->read(first, own); }, row, records);
  }

 private:
  const NumberedRows& rows_;
  std::unique_ptr<RowDecoder> own_;
};

std::unique_ptr<RowDecoder> NumberedRows::decoder(const WantedFields& wanted) const {
  if (!has_decoders()) return nullptr;
  const std::size_t number = info_.schema.fields.size() - 1;
  WantedFields own = wanted;
  std::erase(own, number);
  if (own.empty() && !wanted.empty()) own = {0};  // an empty list would mean all fields
  return std::make_unique<Decoder>(*this, all_->decoder(own));
}

void require_unnumbered(const Reader& reader) {
  if (!has_input_row(reader.info().schema)) return;
  fail("{}: an attribute is called '{}', which pointsweep calls the number of the row; rename it.",
       reader.info().path.string(), kInputRow);
}

std::size_t NumberedRows::read(std::uint64_t row, std::span<std::byte> records) {
  return read_numbered([this](std::uint64_t first, auto own) { return all_->read(first, own); }, row, records);
}

}  // namespace pointsweep
