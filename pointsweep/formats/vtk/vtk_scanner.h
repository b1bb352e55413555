// SPDX-License-Identifier: MIT
/// The text of a VTK file, by words and by lines.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "pointsweep/formats/files/input_file.h"

namespace pointsweep {

/// A window of 16 KB on a file that is text between blocks of bytes. Words and lines longer than that are an Error.
class VtkScanner {
 public:
  explicit VtkScanner(const InputFile& file) : file_(&file) {}

  /// The next word, over ends of lines, valid until the next call; nothing at the end of the file.
  std::optional<std::string_view> word();
  /// Returns the rest of the line, without its end; none at the end of the file.
  std::optional<std::string_view> line();
  /// Passes over so many words and returns how many there were.
  std::uint64_t skip_words(std::uint64_t words);
  void jump(std::uint64_t offset);
  std::uint64_t offset() const { return block_offset_ + at_; }

 private:
  bool skip_blanks();
  bool read_more();

  const InputFile* file_;
  std::vector<std::byte> block_;
  std::size_t at_ = 0, end_ = 0;
  std::uint64_t block_offset_ = 0;
};

}  // namespace pointsweep
