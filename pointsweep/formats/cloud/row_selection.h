// SPDX-License-Identifier: MIT
/// A selection of the rows of a cloud. The kept rows are numbered from 0.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace pointsweep {

/// One bit for each row, in blocks that are read when needed. A selection takes 8 bytes of memory for 4,096 rows. Many
/// threads may use one selection, each with its own SelectionCursor.
class RowSelection {
 public:
  static constexpr std::uint64_t kBlockRows = 4096;
  static constexpr std::size_t kBlockBytes = kBlockRows / 8;

  /// `read(block, bits)` fills `bits`, which has kBlockBytes bytes, with the bits of a block: bit i % 8 of byte i / 8
  /// is set if row i of the block is kept; bits after the last row are 0. The constructor calls `read` for every block;
  /// later, any thread may call `read`.
  RowSelection(std::uint64_t rows, std::function<void(std::uint64_t block, std::span<std::byte> bits)> read);

  std::uint64_t rows() const { return rows_; }            ///< number of rows of the whole cloud
  std::uint64_t count() const { return before_.back(); }  ///< number of kept rows

 private:
  friend class SelectionCursor;
  std::uint64_t blocks() const { return before_.size() - 1; }
  std::uint64_t block_of(std::uint64_t kept) const;
  bool is_whole(std::uint64_t block) const;

  std::uint64_t rows_;
  std::function<void(std::uint64_t, std::span<std::byte>)> read_bits_;
  std::vector<std::uint64_t> before_;  ///< kept rows before each block, and in total
};

/// Access to a selection for one thread. Keeps the bits of the latest block.
class SelectionCursor {
 public:
  /// `selection` must outlive the cursor.
  explicit SelectionCursor(const RowSelection& selection) : selection_(&selection), bits_(RowSelection::kBlockBytes) {}

  /// Returns whether row `row` of the whole cloud is kept.
  bool has(std::uint64_t row);
  /// Returns the row in the whole cloud of the kept row `kept`.
  std::uint64_t row_of(std::uint64_t kept);
  /// Returns how many rows before row `row` of the whole cloud are kept. `row` may be the end.
  std::uint64_t kept_before(std::uint64_t row);

  /// Reads kept rows of `stride` bytes from kept row `first` on: as many whole records as fit, or as there are. Returns
  /// their number. `read_all(row, records)` fills `records` with rows of the whole cloud, and is called only for rows
  /// between the first and the last kept row that is read.
  using ReadAll = std::function<void(std::uint64_t row, std::span<std::byte> records)>;
  std::size_t read(std::uint64_t first, std::size_t stride, std::span<std::byte> records, const ReadAll& read_all);

 private:
  void load_bits(std::uint64_t block);
  std::uint64_t place_in_block(std::uint64_t block, std::uint64_t kept);
  void read_in_block(std::uint64_t block, std::uint64_t first, std::size_t n, std::size_t stride, std::byte* to,
                     const ReadAll& read_all);

  const RowSelection* selection_;
  std::uint64_t bits_of_ = ~std::uint64_t{0};
  std::vector<std::byte> bits_;
  std::vector<std::byte> records_;  ///< records of a block, including rows that are not kept
};

}  // namespace pointsweep
