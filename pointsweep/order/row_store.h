// SPDX-License-Identifier: MIT
/// Stores of one record for each row. RowStore takes results in the order of a sweep and returns them by row: a second
/// distribution, by row, so that the output is written sequentially. The paper's deferred write uses a memory-mapped
/// array instead. RowFile takes records in the order of rows, which one pass carries to the next.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "pointsweep/order/page_memory.h"
#include "pointsweep/storage/encoding.h"
#include "pointsweep/storage/local/spill_file.h"

namespace pointsweep {

/// One record for each row, 0 <= row < rows: an array in memory, or one list per range of rows in a spill file. A row
/// without put() has the record `fill`. All records have the size of `fill`.
class RowStore {
 public:
  /// Without a spill place, all records are in memory. With one, memory stays below `buffer_bytes`.
  RowStore(std::uint64_t rows, std::vector<std::byte> fill, const SpillPlace& spill, std::size_t buffer_bytes);
  /// Decodes a store whose records are in the file `kept`. `buffer_bytes` may differ from that of the encoded store.
  RowStore(Decoder& in, std::uint64_t rows, std::vector<std::byte> fill, const SpillPlace& kept,
           std::size_t buffer_bytes);
  ~RowStore();

  /// Stores records.size()/record_bytes records, record i at rows[i]. Thread-safe; a row must not be put twice.
  void put(std::span<const std::uint64_t> rows, std::span<const std::byte> records);

  /// Calls `consume(first_row, records)` for consecutive runs that cover all rows in order. Must be called after the
  /// last put().
  void drain(const std::function<void(std::uint64_t first_row, std::span<const std::byte> records)>& consume);
  std::uint64_t spilled_bytes() const;
  /// Writes all records so far to the kept file, and encodes their places in it. Only for a store in a kept file. No
  /// thread may call put() at the same time.
  void encode(Encoder& out);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Collects records that arrive row by row, and puts them into a store, 4,096 at a time.
class BatchedRows {
 public:
  /// `bytes`: bytes of a record.
  BatchedRows(RowStore& store, std::size_t bytes) : store_(store), bytes_(bytes) {}
  /// Returns a place for the record of a row, filled with zeros. The place is valid until the next call.
  std::byte* add(std::uint64_t row) {
    if (rows_.size() == kMost) flush();
    rows_.push_back(row);
    records_.resize(records_.size() + bytes_);
    return records_.data() + records_.size() - bytes_;
  }
  /// Hands the collected records to the store. Must be called after the last add().
  void flush() {
    store_.put(rows_, records_);
    rows_.clear();
    records_.clear();
  }

 private:
  static constexpr std::size_t kMost = 4096;
  RowStore& store_;
  std::size_t bytes_;
  std::vector<std::uint64_t> rows_;
  std::vector<std::byte> records_;
};

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
