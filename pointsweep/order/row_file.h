// SPDX-License-Identifier: MIT
/// Records of all rows, carried from one pass to the next in memory or in a temporary file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "pointsweep/order/page_memory.h"
#include "pointsweep/storage/local/spill_file.h"

namespace pointsweep {

class RowFile {
 public:
  /// Makes room for `rows` records of `record_bytes`, in memory or in a spill file.
  RowFile(std::uint64_t rows, std::size_t record_bytes, const SpillPlace& spill);
  /// Fills `records` from `row` on; thread-safe. Reads records that are stored elsewhere.
  using ReadRecords = std::function<void(std::uint64_t row, std::span<std::byte> records)>;
  /// Refers to `rows` records that are stored elsewhere.
  RowFile(std::uint64_t rows, std::size_t record_bytes, ReadRecords read);
  /// Opens the file `kept`, which holds `rows` records.
  static RowFile kept(std::uint64_t rows, std::size_t record_bytes, const SpillPlace& kept);

  /// Appends whole records, up to `rows` of them in all. Throws Error if the disk is full.
  void append(std::span<const std::byte> records);
  /// Appends `rows` records that write() will fill, and returns the row of the first.
  std::uint64_t extend(std::uint64_t rows);
  /// Stores whole records from `row` on. Thread-safe for different rows. Throws Error if the disk is full.
  void write(std::uint64_t row, std::span<const std::byte> records);
  /// Fills `records` (whole records, all appended before) from `row` on. Thread-safe.
  void read(std::uint64_t row, std::span<std::byte> records) const;
  std::size_t record_bytes() const { return record_bytes_; }
  std::uint64_t spilled_bytes() const { return file_ ? file_->written_bytes() : 0; }

 private:
  explicit RowFile(std::size_t record_bytes) : record_bytes_(record_bytes) {}

  std::size_t record_bytes_;
  std::uint64_t rows_ = 0;  ///< number of records appended so far
  PageMemory memory_;
  std::unique_ptr<SpillFile> file_;
  ReadRecords elsewhere_;
};

}  // namespace pointsweep
