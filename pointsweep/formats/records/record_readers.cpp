// SPDX-License-Identifier: MIT
#include "pointsweep/formats/records/record_readers.h"

#include <algorithm>
#include <cstring>
#include <initializer_list>
#include <string_view>

#include "pointsweep/formats/field_names.h"
#include "pointsweep/points/lower_case.h"

namespace pointsweep {
namespace {

/// Number of rows in a chunk. The number is arbitrary; reading a chunk takes some milliseconds.
constexpr std::uint64_t kColumnChunkRows = 65536;
constexpr std::size_t kBlockBytes = 256 << 10;  ///< bytes of one column that a thread reads at a time

/// Copies rows of `bytes` bytes to places `stride` bytes apart.
void scatter(const std::byte* from, std::size_t bytes, std::size_t rows, std::byte* to, std::size_t stride) {
  if (bytes == 4) {
    for (std::size_t i = 0; i < rows; ++i) std::memcpy(to + i * stride, from + i * 4, 4);
  } else if (bytes == 8) {
    for (std::size_t i = 0; i < rows; ++i) std::memcpy(to + i * stride, from + i * 8, 8);
  } else {
    for (std::size_t i = 0; i < rows; ++i) std::memcpy(to + i * stride, from + i * bytes, bytes);
  }
}

/// Reverses the bytes of every value of `fields` in records of `stride` bytes.
void reverse_values(std::span<const Field> fields, std::size_t stride, std::span<std::byte> records) {
  if (fields.empty()) return;
  for (std::byte *record = records.data(), *end = record + records.size(); record != end; record += stride) {
    for (const Field& field : fields) {
      const std::size_t size = size_of(field.type);
      if (size == 1) continue;
      std::byte* value = record + field.offset;
      for (std::uint32_t i = 0; i < field.count; ++i, value += size) std::reverse(value, value + size);
    }
  }
}

bool is_word_of(std::string_view name, std::initializer_list<std::string_view> names) {
  return std::ranges::find(names, name) != names.end();
}

/// Returns the library's names of the components; none for an unknown array.
std::vector<std::string> known_components(const std::string& name, Type type, std::uint32_t components) {
  const std::string lower = in_lower_case(name);
  const bool real = type == Type::f32 || type == Type::f64;
  if (components == 3 && real && is_word_of(lower, {"normal", "normals"})) return {"nx", "ny", "nz"};
  if (components == 3 && is_word_of(lower, {"xyz", "points", "position", "positions", "vertices", "coordinates"}))
    return {"x", "y", "z"};
  if (components != 3 && components != 4) return {};
  if (type != Type::u8 || !is_word_of(lower, {"color", "colors", "colour", "colours", "rgb", "rgba"})) return {};
  std::vector<std::string> names{"red", "green", "blue", "alpha"};
  names.resize(components);
  return names;
}

}  // namespace

class ColumnsReader::Decoder final : public RowDecoder {
 public:
  Decoder(const ColumnsReader& reader, const WantedFields& wanted) : reader_(reader) {
    const std::vector<Field>& fields = reader.info().schema.fields;
    for (const StoredColumn& column : reader.columns_) {
      const auto is_here = [&](std::size_t f) { return fields[f].offset - column.offset < column.bytes; };
      if (wanted.empty() || std::ranges::any_of(wanted, is_here)) columns_.push_back(&column);
    }
  }

  std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
    const std::size_t rows = reader_.rows_for(row, records), stride = reader_.info().schema.stride;
    if (rows == 0) return 0;
    for (const StoredColumn* column : columns_) read_column(*column, row, rows, records.data());
    reverse_values(reader_.big_endian_, stride, records.first(rows * stride));
    return rows;
  }

 private:
  void read_column(const StoredColumn& column, std::uint64_t row, std::size_t rows, std::byte* records) {
    const std::size_t stride = reader_.info().schema.stride;
    if (reader_.is_record(column))
      return reader_.file_->read_at(column.begin + row * stride, std::span(records, rows * stride));
    const std::size_t block = std::max<std::size_t>(1, kBlockBytes / column.bytes);
    for (std::size_t first = 0; first < rows; first += block) {
      const std::size_t n = std::min(block, rows - first);
      values_.resize(n * column.bytes);
      reader_.file_->read_at(column.begin + (row + first) * column.bytes, values_);
      scatter(values_.data(), column.bytes, n, records + first * stride + column.offset, stride);
    }
  }

  const ColumnsReader& reader_;
  std::vector<const StoredColumn*> columns_;
  std::vector<std::byte> values_;
};

void ColumnsReader::has_columns(std::shared_ptr<const InputFile> file, std::vector<StoredColumn> columns,
                                std::vector<Field> big_endian) {
  file_ = std::move(file);
  columns_ = std::move(columns);
  big_endian_ = std::move(big_endian);
  info_.decoder_bytes = 0;
  for (const StoredColumn& column : columns_)
    if (!is_record(column))
      info_.decoder_bytes = std::max<std::uint64_t>({info_.decoder_bytes, kBlockBytes, column.bytes});
}

Chunk ColumnsReader::chunk_of(std::uint64_t row) const {
  const std::uint64_t first = row / kColumnChunkRows * kColumnChunkRows;
  const std::uint64_t rows = std::min(kColumnChunkRows, info_.count - first), stride = info_.schema.stride;
  if (!is_record(columns_.front())) return {.first_row = first, .rows = rows, .bounds = {}};
  const std::uint64_t begin = columns_.front().begin;
  return {first, rows, begin + first * stride, begin + (first + rows) * stride, std::nullopt};
}

std::unique_ptr<RowDecoder> ColumnsReader::decoder(const WantedFields& wanted) const {
  return std::make_unique<Decoder>(*this, wanted);
}

std::size_t append_array(Schema& schema, const std::string& name, Type type, std::uint32_t components) {
  const std::size_t first = schema.fields.size();
  const std::vector<std::string> known = known_components(name, type, components);
  if (!known.empty() && std::ranges::none_of(known, [&](const auto& n) { return has_name(schema, n); })) {
    for (const std::string& component : known) schema.append(component, type);
    return first;
  }
  schema.append(unused_name(schema, name), type, components);
  return first;
}

class RowTextReader::Decoder final : public RowDecoder {
 public:
  explicit Decoder(const RowTextReader& reader) : reader_(reader), lines_(*reader.rows_), parser_(reader.parser()) {}

  std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
    const std::size_t rows = reader_.rows_for(row, records), stride = reader_.info().schema.stride;
    for (std::size_t i = 0; i < rows; ++i) {
      const std::string_view line = lines_.at(row + i);
      parser_->parse(line, lines_.line(), records.data() + i * stride);
    }
    return rows;
  }

 private:
  const RowTextReader& reader_;
  RowCursor lines_;
  std::unique_ptr<LineParser> parser_;
};

Chunk RowTextReader::chunk_of(std::uint64_t row) const {
  const std::uint64_t place = row / RowLines::kRowsPerPlace, first = place * RowLines::kRowsPerPlace;
  return {first, std::min(RowLines::kRowsPerPlace, info_.count - first), rows_->begin_of(place), rows_->end_of(place),
          std::nullopt};
}

std::unique_ptr<RowDecoder> RowTextReader::decoder(const WantedFields&) const {
  return std::make_unique<Decoder>(*this);
}

}  // namespace pointsweep
