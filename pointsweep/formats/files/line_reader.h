// SPDX-License-Identifier: MIT
/// A reader of the lines of a file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "pointsweep/storage/local/input_file.h"

namespace pointsweep {

/// Reads lines that end with LF or CRLF; the last line may lack its end. A line of more than 1 MiB is an Error, so that
/// a file without line ends is not read into memory.
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

}  // namespace pointsweep
