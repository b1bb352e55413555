// SPDX-License-Identifier: MIT
#include "pointsweep/formats/records/fixed_records.h"

#include <algorithm>
#include <utility>

namespace pointsweep {

namespace {

/// Any number would do; so many are read in some milliseconds.
constexpr std::uint64_t kFixedChunkRows = 65536;

}  // namespace

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

class FixedRecordReader::Decoder final : public RowDecoder {
 public:
  explicit Decoder(const FixedRecordReader& reader) : reader_(reader) {}
  std::size_t read(std::uint64_t row, std::span<std::byte> records) override { return reader_.decode(row, records); }

 private:
  const FixedRecordReader& reader_;
};

void FixedRecordReader::has_records(std::shared_ptr<const InputFile> file, std::uint64_t first,
                                    std::vector<Field> big_endian) {
  file_ = std::move(file);
  first_ = first;
  big_endian_ = std::move(big_endian);
}

Chunk FixedRecordReader::chunk_of(std::uint64_t row) const {
  const std::uint64_t begin = row / kFixedChunkRows * kFixedChunkRows;
  const std::uint64_t rows = std::min(kFixedChunkRows, info_.count - begin), stride = info_.schema.stride;
  return {begin, rows, first_ + begin * stride, first_ + (begin + rows) * stride, std::nullopt};
}

std::unique_ptr<RowDecoder> FixedRecordReader::decoder(const WantedFields&) const {
  return std::make_unique<Decoder>(*this);
}

std::size_t FixedRecordReader::decode(std::uint64_t row, std::span<std::byte> records) const {
  const std::size_t rows = rows_for(row, records), stride = info_.schema.stride;
  if (rows == 0) return 0;
  const auto bytes = records.first(rows * stride);
  file_->read_at(first_ + row * stride, bytes);
  reverse_values(big_endian_, stride, bytes);
  return rows;
}

}  // namespace pointsweep
