// SPDX-License-Identifier: MIT
/// Files whose points are records of one size, one after another.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "pointsweep/formats/files/input_file.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/reader.h"

namespace pointsweep {

/// Reverses the bytes of every value of `fields` in records of `stride` bytes.
void reverse_values(std::span<const Field> fields, std::size_t stride, std::span<std::byte> records);

/// Any range of rows is a chunk. Records are the bytes of the file; big-endian numbers are byte-swapped.
class FixedRecordReader : public Reader {
 public:
  Chunk chunk_of(std::uint64_t row) const override;
  bool decodes_any_range() const override { return true; }
  bool has_decoders() const override { return true; }
  std::unique_ptr<RowDecoder> decoder(const WantedFields& wanted = {}) const override;

 protected:
  /// Row 0 begins at byte `first`, once info_.schema is known. `big_endian`: the fields whose values are.
  void has_records(std::shared_ptr<const InputFile> file, std::uint64_t first, std::vector<Field> big_endian = {});

 private:
  class Decoder;
  /// Reads records as RowDecoder::read does. Thread-safe.
  std::size_t decode(std::uint64_t row, std::span<std::byte> records) const;

  std::shared_ptr<const InputFile> file_;
  std::uint64_t first_ = 0;  ///< byte
  std::vector<Field> big_endian_;
};

}  // namespace pointsweep
