// SPDX-License-Identifier: MIT
/// Readers that change what another reader reads: only the rows with finite coordinates, or all rows with their
/// numbers.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/math/box.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/reader.h"

namespace pointsweep {

/// Points with NaN or infinite coordinates.
struct NonfiniteRows {
  static constexpr std::size_t kMostListed = 1000;
  std::uint64_t count = 0;
  std::vector<std::uint64_t> rows;  ///< the first nonfinite rows, ascending, at most kMostListed
  std::string first;                ///< "row 17 of scan.ply"; empty if there are none
  Box bounds;                       ///< bounds of all other points
};

/// A function that reads records as RowDecoder::read does.
using ReadInputRows = std::function<std::size_t(std::uint64_t row, std::span<std::byte> records)>;

/// Returns whether a coordinate may be NaN or infinite: false if all are integers whose scaled values are finite.
bool can_be_nonfinite(const Schema& schema, const std::filesystem::path& path);

/// The number of finite rows before each block of 4,096 rows of an input.
class FiniteRowIndex {
 public:
  static constexpr std::uint64_t kBlock = 4096;
  /// Reads all rows of `reader`, on all threads if the reader has decoders, and adds the nonfinite rows to `found`,
  /// where row 0 of the reader has the number `first_row`.
  FiniteRowIndex(Reader& reader, std::uint64_t first_row, NonfiniteRows& found,
                 const std::function<void(std::uint64_t rows)>& progress);
  std::uint64_t count() const { return before_.back(); }  ///< number of finite rows
  bool has_all() const { return count() == rows_; }

  std::size_t blocks() const { return before_.size() - 1; }
  /// Returns the block that holds the finite row `row`.
  std::size_t block_of(std::uint64_t row) const;
  std::uint64_t before(std::size_t block) const { return before_[block]; }
  std::uint64_t rows_in(std::size_t block) const { return std::min(kBlock, rows_ - block * kBlock); }
  bool is_whole(std::size_t block) const { return before_[block + 1] - before_[block] == rows_in(block); }

 private:
  struct Piece;
  std::uint64_t end_of_piece(const Reader& reader, std::uint64_t row) const;
  static void look_at(const FileInfo& info, const ReadInputRows& read, Piece& piece);

  std::uint64_t rows_;
  std::vector<std::uint64_t> before_;  ///< finite rows before each block, and in total
};

/// The finite rows of an input: row i is the i-th finite row of `all`.
class FiniteRows final : public Reader {
 public:
  FiniteRows(std::shared_ptr<Reader> all, FiniteRowIndex index);
  ~FiniteRows() override;

  /// Returns the finite rows of the blocks of 4,096 rows that begin in one chunk of `all`, or all finite rows if rows
  /// of `all` may be split anywhere.
  Chunk chunk_of(std::uint64_t row) const override;
  bool has_decoders() const override { return all_->has_decoders(); }
  bool decodes_any_range() const override { return all_->decodes_any_range(); }
  std::unique_ptr<RowDecoder> decoder(const WantedFields& wanted) const override;
  std::size_t read(std::uint64_t row, std::span<std::byte> records) override;
  void rest() override { all_->rest(); }
  /// Returns the row in the input of the finite row `row`.
  std::uint64_t input_row(std::uint64_t row);
  /// Returns the same row as input_row(), but opens a decoder for the call, which takes longer. Thread-safe if the
  /// reader has decoders.
  std::uint64_t row_of_all(std::uint64_t row) const;

 private:
  class Decoder;
  std::size_t first_block_from(std::uint64_t row) const;

  std::shared_ptr<Reader> all_;
  FiniteRowIndex index_;
  PositionFields position_;
  std::unique_ptr<Decoder> own_;  ///< decoder of read() and input_row()
};

/// The records of `all`, each with the field kInputRow (input_row.h) at its end: the number of the row, counted from
/// `first_row` on.
class NumberedRows final : public Reader {
 public:
  NumberedRows(std::shared_ptr<Reader> all, std::uint64_t first_row);

  Chunk chunk_of(std::uint64_t row) const override { return all_->chunk_of(row); }
  bool has_decoders() const override { return all_->has_decoders(); }
  bool decodes_any_range() const override { return all_->decodes_any_range(); }
  std::unique_ptr<RowDecoder> decoder(const WantedFields& wanted) const override;
  std::size_t read(std::uint64_t row, std::span<std::byte> records) override;
  void rest() override { all_->rest(); }

 private:
  class Decoder;
  template <class Read>
  std::size_t read_numbered(Read read, std::uint64_t row, std::span<std::byte> records) const;

  std::shared_ptr<Reader> all_;
  std::uint64_t first_row_;
};

/// Throws Error if the file of the reader has an attribute that is called kInputRow.
void require_unnumbered(const Reader& reader);

}  // namespace pointsweep
