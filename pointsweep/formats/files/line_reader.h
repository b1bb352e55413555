// SPDX-License-Identifier: MIT
/// Readers of the lines of a file: in sequence, and by number for the rows of a text file of any size.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "pointsweep/storage/local/input_file.h"

namespace pointsweep {

/// Reads lines that end with LF or CRLF; the last line may lack its end. A line of more than about 1 MiB is an Error,
/// so that a file without line ends is not read into memory.
class LineReader {
 public:
  explicit LineReader(const InputFile& file) : file_(&file) {}

  /// Returns the next line without its end, valid until the next call; nothing at the end of the file.
  std::optional<std::string_view> next();
  /// Continues at `offset`, where line number `line` (from 1) starts.
  void jump(std::uint64_t offset, std::uint64_t line);

  const InputFile& file() const { return *file_; }
  std::uint64_t offset() const { return block_offset_ + at_; }  ///< where the next line starts
  std::uint64_t next_line() const { return next_line_; }        ///< number of the next line, from 1
  std::uint64_t line() const { return next_line_ - 1; }         ///< number of the line that next() returned last

 private:
  bool read_more();

  const InputFile* file_;
  std::vector<std::byte> block_;
  std::size_t at_ = 0, end_ = 0;  ///< range of the unread bytes in the block
  std::uint64_t block_offset_ = 0;
  std::uint64_t next_line_ = 1;
};

/// Counts the rows of a file, that is, the lines that hold values, and keeps the place of every 16,384th row. Several
/// threads can read between these places side by side, and a jump reads at most 16,384 rows again.
class RowLines {
 public:
  using IsRow = bool (*)(std::string_view line);
  struct Place {
    std::uint64_t offset, line;
  };
  static constexpr std::uint64_t kRowsPerPlace = 16384;

  /// A function that is called once for each line that is not a row, with the number of the line and the number of rows
  /// before it.
  using UseOther = std::function<void(std::string_view line, std::uint64_t number, std::uint64_t rows)>;

  /// Counts the rows from the position of `lines` on, and stops after `most` rows.
  RowLines(LineReader lines, IsRow is_a_row, std::uint64_t most, const UseOther& use_other = {});

  std::uint64_t count() const { return count_; }
  const InputFile& file() const { return *file_; }
  bool is_row(std::string_view line) const { return is_row_(line); }
  /// Returns the place of row i * kRowsPerPlace < count().
  const Place& place(std::uint64_t i) const { return places_[i]; }
  /// Return the range of bytes, [begin_of(i), end_of(i)), of the rows from place i to the next place.
  std::uint64_t begin_of(std::uint64_t i) const { return places_[i].offset; }
  std::uint64_t end_of(std::uint64_t i) const { return i + 1 < places_.size() ? places_[i + 1].offset : end_; }

 private:
  const InputFile* file_;
  IsRow is_row_;
  std::vector<Place> places_;  ///< places of the rows 0, kRowsPerPlace, ...
  std::uint64_t count_ = 0;
  std::uint64_t end_ = 0;  ///< byte after the last line that the constructor read
};

/// Reads rows by number for one thread.
class RowCursor {
 public:
  /// `rows` must outlive the cursor.
  explicit RowCursor(const RowLines& rows) : rows_(&rows), lines_(rows.file()), next_row_(rows.count()) {}

  /// Returns the line of row `row` < count(), valid until the next call. Fast for the row after the row returned last.
  /// Throws Error if the file has fewer rows than when it was opened.
  std::string_view at(std::uint64_t row);
  /// Frees the buffer until the next call of at().
  void rest() { *this = RowCursor(*rows_); }
  /// Returns the number in the file, from 1, of the line that at() returned last.
  std::uint64_t line() const { return lines_.line(); }

 private:
  /// Returns the next line that is a row. Throws at the end of the file.
  std::string_view advance();

  const RowLines* rows_;
  LineReader lines_;
  std::uint64_t next_row_;  ///< row that advance() returns next; count() if unknown, so that at() searches from a place
};

}  // namespace pointsweep
