// SPDX-License-Identifier: MIT
/// Batches of records that arrive row by row and go to a RowStore.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pointsweep/order/row_store.h"

namespace pointsweep {

/// Brings records to a store, 4,096 at a time.
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

}  // namespace pointsweep
