// SPDX-License-Identifier: MIT
/// The vertices of mesh files in text: one line each, with x y z and perhaps more numbers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "pointsweep/formats/files/line_reader.h"
#include "pointsweep/reader.h"
#include "pointsweep/storage/local/input_file.h"

namespace pointsweep {

/// The meaning of the numbers of a line, in order. Coordinates, normals and texture coordinates are read as float64;
/// colours as uint8, from the range [0, 1] if no colour in the file is larger than 1, else from [0, 255].
struct VertexColumns {
  bool normal = false;
  std::size_t color = 0;  ///< components: 0, 3 or 4
  bool texture = false;
  std::size_t ignored = 0;  ///< further numbers at the end of the line
};

/// Reads the vertices of a mesh file, one line each. The constructor of a subclass finds the columns and sets them.
class VertexLineReader : public Reader {
 public:
  std::size_t read(std::uint64_t row, std::span<std::byte> records) override;
  /// Stores the values of the lines of `rows` rows, `stride` bytes apart; all rows must exist.
  void fill(std::uint64_t row, std::size_t rows, std::byte* to, std::size_t stride);

 protected:
  /// The rows are the lines for which `is_row` is true, from the position of `lines` on, at most `most`. `has_keyword`:
  /// each line has a word before its numbers.
  VertexLineReader(std::unique_ptr<InputFile> file, const LineReader& lines, RowLines::IsRow is_row, std::uint64_t most,
                   bool has_keyword);

  const InputFile& file() const { return *file_; }
  std::string_view first_line() { return cursor_.at(0); }  ///< there must be a row
  /// Returns the numbers in a line, after its keyword; valid until the next call.
  const std::vector<double>& numbers(std::string_view line);
  /// Makes the fields. Reads all colours to find their range.
  void set_columns(const VertexColumns& columns);
  std::uint64_t rows() const { return rows_.count(); }

 private:
  std::unique_ptr<InputFile> file_;
  RowLines rows_;
  RowCursor cursor_{rows_};
  bool has_keyword_;
  VertexColumns columns_;
  std::size_t width_ = 3;  ///< numbers in a line
  double color_scale_ = 1;
  std::vector<double> numbers_;
};

}  // namespace pointsweep
