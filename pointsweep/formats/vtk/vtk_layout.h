// SPDX-License-Identifier: MIT
/// The contents of a legacy VTK file and their places, and a scanner of its text by words and lines.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/points/schema.h"
#include "pointsweep/storage/local/input_file.h"

namespace pointsweep {

/// An array of the file, with one row of `components` values for each point.
struct VtkArray {
  std::string name;
  Type type = Type::f32;
  std::uint32_t components = 1;
  bool shares = false;                     ///< true if the text states bytes as numbers in [0, 1], to be scaled by 255
  std::uint64_t begin = 0;                 ///< byte of the first value in a binary file
  std::vector<std::uint64_t> places = {};  ///< in text: offsets of rows 0, VtkLayout::kRowsPerPlace, ...
};

struct VtkLayout {
  static constexpr std::uint64_t kRowsPerPlace = 16384;

  bool text = false;
  std::string dataset;                ///< kind of the data set: "POLYDATA", for example
  std::uint64_t count = 0;            ///< number of points
  std::vector<VtkArray> arrays;       ///< the positions, then attributes of points
  std::uint64_t cells = 0;            ///< number of cells, except the cells of a VERTICES section
  std::vector<std::string> left_out;  ///< names of arrays of points that cannot be kept
};

/// Returns whether a file that begins with `head` is a legacy VTK file.
bool starts_as_vtk(std::string_view head);

/// Reads all of a text file, or the lines between the arrays of a binary file. Throws Error with the place of a fault.
VtkLayout read_vtk_layout(const InputFile& file);

/// Reads a file of text and blocks of bytes through a buffer of 16 KB. A longer word or line is an Error.
class VtkScanner {
 public:
  explicit VtkScanner(const InputFile& file) : file_(&file) {}

  /// Returns the next word, across line ends, valid until the next call; nothing at the end of the file.
  std::optional<std::string_view> word();
  /// Returns the rest of the line, without its end; none at the end of the file.
  std::optional<std::string_view> line();
  /// Skips `words` words and returns how many there were.
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
