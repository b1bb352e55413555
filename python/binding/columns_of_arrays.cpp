// SPDX-License-Identifier: MIT
#include "python/binding/columns_of_arrays.h"

#include <algorithm>
#include <cstring>

#include "pointsweep/fail.h"
#include "pointsweep/points/record_map.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kArrayChunkRows = 65536;  // an arbitrary number; a chunk is copied in about a millisecond

}  // namespace

class ColumnsOfArrays::Decoder final : public RowDecoder {
 public:
  Decoder(const ColumnsOfArrays& reader, const WantedFields& wanted) : reader_(reader) {
    const std::vector<Field>& fields = reader.info().schema.fields;
    for (const Piece& piece : reader.pieces_) {
      const auto is_here = [&](std::size_t f) { return fields[f].offset - piece.offset < piece.bytes; };
      if (wanted.empty() || std::ranges::any_of(wanted, is_here)) pieces_.push_back(piece);
    }
  }

  std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
    const std::size_t rows = reader_.rows_for(row, records), stride = reader_.info().schema.stride;
    for (const Piece& piece : pieces_) {
      std::byte* const to = records.data() + piece.offset;
      piece.first != nullptr ? copy(piece, row, rows, to, stride) : number(row, rows, to, stride);
    }
    return rows;
  }

 private:
  static void copy(const Piece& piece, std::uint64_t row, std::size_t rows, std::byte* to, std::size_t stride) {
    const std::byte* from = piece.first + static_cast<std::ptrdiff_t>(row) * piece.stride;
    with_fixed_size(piece.bytes, [&](auto size) {
      for (std::size_t i = 0; i < rows; ++i, from += piece.stride, to += stride)
        copy_bytes<size()>(to, from, piece.bytes);
    });
  }

  static void number(std::uint64_t row, std::size_t rows, std::byte* to, std::size_t stride) {
    for (std::size_t i = 0; i < rows; ++i, to += stride) {
      const auto value = static_cast<std::int64_t>(row + i);
      std::memcpy(to, &value, sizeof value);
    }
  }

  const ColumnsOfArrays& reader_;
  std::vector<Piece> pieces_;
};

ColumnsOfArrays::ColumnsOfArrays(std::vector<ArrayColumn> columns, bool with_rows, std::optional<Crs> crs)
    : columns_(std::move(columns)) {
  info_.path = "the arrays";
  info_.format = "arrays of Python";
  info_.count = columns_.front().rows;
  info_.crs = std::move(crs);
  for (const ArrayColumn& column : columns_) add(column);
  if (!with_rows) return;
  info_.schema.append(kRowField, Type::i64);
  pieces_.push_back({nullptr, 0, info_.schema.fields.back().offset, sizeof(std::int64_t)});
}

void ColumnsOfArrays::add(const ArrayColumn& column) {
  if (column.rows != info_.count)
    fail_usage("the array for '{}' has {} rows, but there are {} points.", column.names.front(), column.rows,
               info_.count);
  const auto bytes = static_cast<std::uint32_t>(size_of(column.type));
  const auto values = static_cast<std::uint32_t>(column.names.size());
  const std::uint32_t offset = info_.schema.stride;
  for (const std::string& name : column.names) info_.schema.append(name, column.type);
  info_.bytes += column.rows * values * bytes;
  if (column.value_stride == static_cast<std::ptrdiff_t>(bytes))
    return pieces_.push_back({column.first, column.row_stride, offset, values * bytes});
  for (std::uint32_t v = 0; v < values; ++v)
    pieces_.push_back({column.first + v * column.value_stride, column.row_stride, offset + v * bytes, bytes});
}

Chunk ColumnsOfArrays::chunk_of(std::uint64_t row) const {
  const std::uint64_t first = row / kArrayChunkRows * kArrayChunkRows;
  return {.first_row = first, .rows = std::min(kArrayChunkRows, info_.count - first), .bounds = {}};
}

std::unique_ptr<RowDecoder> ColumnsOfArrays::decoder(const WantedFields& wanted) const {
  return std::make_unique<Decoder>(*this, wanted);
}

}  // namespace pointsweep
