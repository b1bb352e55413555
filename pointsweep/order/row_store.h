// SPDX-License-Identifier: MIT
/// Results on their way from sweep order to rows: a second distribution, by row, so that the output is written in
/// sequence instead of scattered (what the paper's deferred write does with a memory-mapped array).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

namespace pointsweep {

class TempFolder;

/// One record of `record_bytes` per row, 0 <= row < rows. In memory an array; spilled, one list per range of rows.
/// A row that nobody puts reads as bytes of value `fill`.
class RowStore {
 public:
  /// `spill` null: an array of rows * record_bytes. Otherwise memory stays under `buffer_bytes`.
  RowStore(std::uint64_t rows, std::size_t record_bytes, std::byte fill, const TempFolder* spill,
           std::size_t buffer_bytes);
  ~RowStore();

  /// Stores records.size()/record_bytes records, record i at rows[i]. Thread-safe; a row must not be put twice.
  void put(std::span<const std::uint64_t> rows, std::span<const std::byte> records);

  /// After the last put(): calls `consume(first_row, records)` for consecutive runs that cover all rows in order.
  void drain(const std::function<void(std::uint64_t first_row, std::span<const std::byte> records)>& consume);
  std::uint64_t spilled_bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pointsweep
