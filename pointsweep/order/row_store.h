// SPDX-License-Identifier: MIT
/// Results on their way from sweep order to rows: a second distribution, by row, so that the output is written in
/// sequence instead of scattered (what the paper's deferred write does with a memory-mapped array).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "pointsweep/storage/encoding.h"
#include "pointsweep/storage/local/spill_file.h"

namespace pointsweep {

/// One record per row, 0 <= row < rows. In memory an array; spilled, one list per range of rows. A row that is never
/// put reads as the record `fill`. All records have the size of `fill`.
class RowStore {
 public:
  /// Without a spill place, all records are held in memory. With one, memory stays under `buffer_bytes`.
  RowStore(std::uint64_t rows, std::vector<std::byte> fill, const SpillPlace& spill, std::size_t buffer_bytes);
  /// Decodes a store whose records are in the file `kept`. `buffer_bytes` may differ from that of the encoded store.
  RowStore(Decoder& in, std::uint64_t rows, std::vector<std::byte> fill, const SpillPlace& kept,
           std::size_t buffer_bytes);
  ~RowStore();

  /// Stores records.size()/record_bytes records, record i at rows[i]. Thread-safe; a row must not be put twice.
  void put(std::span<const std::uint64_t> rows, std::span<const std::byte> records);

  /// After the last put(): calls `consume(first_row, records)` for consecutive runs that cover all rows in order.
  void drain(const std::function<void(std::uint64_t first_row, std::span<const std::byte> records)>& consume);
  std::uint64_t spilled_bytes() const;
  /// Writes all records that were put to the kept file, and encodes their places in it. Only for a store in a kept
  /// file. No thread may call put() meanwhile.
  void encode(Encoder& out);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pointsweep
