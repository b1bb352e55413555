// SPDX-License-Identifier: MIT
/// The rows of a text file of any size, by number.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "pointsweep/formats/files/line_reader.h"

namespace pointsweep {

/// Lines that hold values, counted once, with the place of each 65,536th kept, so that a jump rescans at most that
/// many.
class RowLines {
 public:
  using IsRow = bool (*)(std::string_view line);

  /// Counts the rows among the lines from where `lines` stands, and stops after `most` of them.
  RowLines(const LineReader& lines, IsRow is_row, std::uint64_t most);

  std::uint64_t count() const { return count_; }
  /// Line `row` < count(), valid until the next call; quick for the row after the last. Throws if the file has changed.
  std::string_view at(std::uint64_t row);
  /// Frees the buffer until the next call of at().
  void rest();
  /// Number in the file, from 1, of the line that at() returned last.
  std::uint64_t line() const { return lines_.line(); }

 private:
  struct Place {
    std::uint64_t offset, line;
  };
  /// The next line that is a row; throws at the end of the file.
  std::string_view advance();

  LineReader lines_;
  IsRow is_row_;
  std::vector<Place> places_;  ///< of rows 0, 65,536, ...
  std::uint64_t count_ = 0;
  std::uint64_t next_row_ = 0;
};

}  // namespace pointsweep
