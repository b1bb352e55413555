// SPDX-License-Identifier: MIT
/// Stores of one record for each row of the input. RowStore takes results in the order of a sweep and returns them by
/// row, so that the output is written sequentially; the paper's deferred write uses a memory-mapped array instead.
/// RowFile stores records in the order of rows. A kept file (SpillPlace) is not deleted when the process ends, so that
/// a resumed run can decode the stores in it.
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
  /// Without a spill place, all records are in memory. With a spill place, the buffers take about `buffer_bytes`.
  RowStore(std::uint64_t rows, std::vector<std::byte> fill, const SpillPlace& spill, std::size_t buffer_bytes);
  /// Decodes a store whose records are in the kept file `kept`. `buffer_bytes` may have changed since encode().
  RowStore(Decoder& in, std::uint64_t rows, std::vector<std::byte> fill, const SpillPlace& kept,
           std::size_t buffer_bytes);
  ~RowStore();

  /// Stores record i of `records` as the record of row rows[i]. Thread-safe; a row must not be put twice.
  void put(std::span<const std::uint64_t> rows, std::span<const std::byte> records);

  /// Calls `consume(first_row, records)` for consecutive runs of rows that cover all rows in order. Must be called
  /// after the last put().
  void drain(const std::function<void(std::uint64_t first_row, std::span<const std::byte> records)>& consume);
  std::uint64_t spilled_bytes() const;
  /// Writes all records so far to the kept file, and encodes where the file has them. Only for a store in a kept file.
  /// No thread may call put() at the same time.
  void encode(Encoder& out);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Collects records that one thread makes row by row, and puts them into a store, 4,096 at a time.
class BatchedRows {
 public:
  /// `bytes`: bytes of a record.
  BatchedRows(RowStore& store, std::size_t bytes) : store_(store), bytes_(bytes) {}
  /// Returns a zeroed place for the record of a row, valid until the next call of add() or flush().
  std::byte* add(std::uint64_t row) {
    if (rows_.size() == kMost) flush();
    rows_.push_back(row);
    records_.resize(records_.size() + bytes_);
    return records_.data() + records_.size() - bytes_;
  }
  /// Puts the collected records into the store. Must be called after the last add().
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

/// Records of one size in the order of rows, in memory, in a spill file, or behind a function. Holds, for example, the
/// values that one pass over a cloud carries to the next.
class RowFile {
 public:
  /// Makes room for `rows` records of `record_bytes` bytes, in a spill file or, without a spill place, in memory.
  RowFile(std::uint64_t rows, std::size_t record_bytes, const SpillPlace& spill);
  /// Fills `records` from `row` on with records that are stored elsewhere. Must be thread-safe.
  using ReadRecords = std::function<void(std::uint64_t row, std::span<std::byte> records)>;
  /// Makes a store of `rows` records that `read` returns; append(), extend() and write() must not be called.
  RowFile(std::uint64_t rows, std::size_t record_bytes, ReadRecords read);
  /// Opens the kept file `kept`, which holds `rows` records.
  static RowFile kept(std::uint64_t rows, std::size_t record_bytes, const SpillPlace& kept);

  /// Appends whole records, up to `rows` of them in all. Throws Error if the disk is full.
  void append(std::span<const std::byte> records);
  /// Appends `rows` records that write() will fill, and returns the row of the first record. Not thread-safe.
  std::uint64_t extend(std::uint64_t rows);
  /// Stores whole records from `row` on. Thread-safe for different rows. Throws Error if the disk is full.
  void write(std::uint64_t row, std::span<const std::byte> records);
  /// Fills `records` with the records from `row` on, all appended before. Thread-safe.
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
