// SPDX-License-Identifier: MIT
/// Some rows of a cloud as a cloud of their own: row i is the i-th row that was kept.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace pointsweep {

/// A bit for each row, in blocks, wherever they are kept. 8 bytes of memory for 4,096 rows.
class RowSelection {
 public:
  static constexpr std::uint64_t kBlockRows = 4096;
  static constexpr std::size_t kBlockBytes = kBlockRows / 8;

  /// `read(block, bits)` fills `bits`, kBlockBytes, with the bits of a block: bit i % 8 of byte i / 8 is set if its row
  /// i is kept. Reads every block once.
  RowSelection(std::uint64_t rows, std::function<void(std::uint64_t block, std::span<std::byte> bits)> read);

  std::uint64_t rows() const { return rows_; }            ///< of the whole cloud
  std::uint64_t count() const { return before_.back(); }  ///< of those kept
  std::uint64_t row_of(std::uint64_t kept) const;         ///< of the whole cloud
  bool has(std::uint64_t row) const;

  /// Reads kept rows: as many whole records of `stride` bytes from kept row `first` on as fit. `read_all(row, records)`
  /// fills `records` with rows of the whole cloud.
  using ReadAll = std::function<void(std::uint64_t row, std::span<std::byte> records)>;
  std::size_t read(std::uint64_t first, std::size_t stride, std::span<std::byte> records, const ReadAll& read_all);

 private:
  std::uint64_t blocks() const { return before_.size() - 1; }
  std::uint64_t rows_in(std::uint64_t block) const;
  bool is_whole(std::uint64_t block) const { return before_[block + 1] - before_[block] == rows_in(block); }
  void load_bits(std::uint64_t block) const;
  void load_records(std::uint64_t block, std::size_t stride, const ReadAll& read_all);

  std::uint64_t rows_;
  std::function<void(std::uint64_t, std::span<std::byte>)> read_bits_;
  std::vector<std::uint64_t> before_;  ///< kept rows before each block, and in all
  mutable std::uint64_t bits_of_ = ~std::uint64_t{0};
  mutable std::vector<std::byte> bits_;
  std::uint64_t records_of_ = ~std::uint64_t{0};
  std::vector<std::byte> records_;  ///< the kept ones of a block
};

}  // namespace pointsweep
