// SPDX-License-Identifier: MIT
#include "pointsweep/formats/mesh/vertex_lines.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/formats/files/number_text.h"

namespace pointsweep {
namespace {

constexpr double kMostColor = 255;

}  // namespace

VertexLineReader::VertexLineReader(std::unique_ptr<InputFile> file, const LineReader& lines, RowLines::IsRow is_row,
                                   std::uint64_t most, bool has_keyword)
    : file_(std::move(file)), rows_(lines, is_row, most), has_keyword_(has_keyword) {
  info_.path = file_->path();
  info_.bytes = file_->size();
  info_.count = rows_.count();
}

const std::vector<double>& VertexLineReader::numbers(std::string_view line) {
  numbers_.clear();
  if (has_keyword_) take_word(line);
  for (std::string_view word = take_word(line); !word.empty() && word[0] != '#'; word = take_word(line)) {
    double value = 0;
    if (!parse_number(word, value))
      fail("{}: line {}: '{}' is no number; correct it.", file_->path().string(), cursor_.line(), word.substr(0, 40));
    numbers_.push_back(value);
  }
  return numbers_;
}

void VertexLineReader::set_columns(const VertexColumns& columns) {
  columns_ = columns;
  for (const char* axis : {"x", "y", "z"}) info_.schema.append(axis, Type::f64);
  if (columns.normal)
    for (const char* axis : {"nx", "ny", "nz"}) info_.schema.append(axis, Type::f64);
  if (columns.texture)
    for (const char* axis : {"texture_u", "texture_v"}) info_.schema.append(axis, Type::f64);
  const char* const colors[] = {"red", "green", "blue", "alpha"};
  for (std::size_t c = 0; c < columns.color; ++c) info_.schema.append(colors[c], Type::u8);
  width_ = 3 + (columns.normal ? 3 : 0) + columns.color + (columns.texture ? 2 : 0) + columns.ignored;
  if (columns.color == 0) return;
  const std::size_t first = columns.normal ? 6 : 3;
  bool fractions = true;
  for (std::uint64_t row = 0; row < rows_.count() && fractions; ++row) {
    if (row % 65536 == 0) stop_if_cancelled();
    const std::vector<double>& values = numbers(cursor_.at(row));
    for (std::size_t c = first; c < std::min(first + columns.color, values.size()); ++c)
      fractions = fractions && values[c] <= 1;
  }
  color_scale_ = fractions ? kMostColor : 1;
  cursor_.rest();
}

std::size_t VertexLineReader::read(std::uint64_t row, std::span<std::byte> records) {
  const std::size_t rows = rows_for(row, records);
  fill(row, rows, records.data(), info_.schema.stride);
  return rows;
}

/// A line has x y z, then the normal, the colour and texture coordinates, as far as the file has these.
void VertexLineReader::fill(std::uint64_t row, std::size_t rows, std::byte* records, std::size_t stride) {
  const std::size_t lengths = 3 + (columns_.normal ? 3 : 0);
  for (std::size_t i = 0; i < rows; ++i, records += stride) {
    const std::vector<double>& values = numbers(cursor_.at(row + i));
    if (values.size() != width_)
      fail("{}: line {} has {} numbers where the first vertex has {}; correct the line.", file_->path().string(),
           cursor_.line(), values.size(), width_);
    std::byte* to = records;
    std::memcpy(to, values.data(), lengths * sizeof(double));
    to += lengths * sizeof(double);
    if (columns_.texture) {
      std::memcpy(to, values.data() + lengths + columns_.color, 2 * sizeof(double));
      to += 2 * sizeof(double);
    }
    for (std::size_t c = 0; c < columns_.color; ++c)
      *to++ = static_cast<std::byte>(std::lround(std::clamp(values[lengths + c] * color_scale_, 0.0, kMostColor)));
  }
  if (rows != 0 && row + rows == info_.count) cursor_.rest();
}

}  // namespace pointsweep
