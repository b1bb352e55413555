// SPDX-License-Identifier: MIT
#include "pointsweep/operators/rows/affine_map.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "pointsweep/fail.h"
#include "pointsweep/number_from.h"
#include "pointsweep/points/text_file.h"

namespace pointsweep {
namespace {

constexpr double kLeastDeterminant = 1e-12;  ///< smaller determinants of rows of length 1 may be rounding errors
constexpr std::string_view kBetweenNumbers = " \t\r\n,;[]";
constexpr const char* kRemedy = "a matrix is 4 rows of 4 numbers, or its first 3 rows";

Vec3 linear_part(const AffineMap::Row& row) { return {row[0], row[1], row[2]}; }

/// A word of a text, and the number of its line, from 1.
struct Word {
  std::string_view text;
  std::size_t line;
};

std::vector<Word> words_of_matrix(std::string_view text) {
  std::vector<Word> words;
  std::size_t line = 1;
  for (std::size_t at = 0; at < text.size();) {
    if (text[at] == '#' && (at == 0 || text[at - 1] == '\n')) {
      at = std::min(text.find('\n', at), text.size());
      continue;
    }
    if (text[at] == '\n') ++line;
    if (kBetweenNumbers.find(text[at]) != kBetweenNumbers.npos) {
      ++at;
      continue;
    }
    const std::size_t end = std::min(text.find_first_of(kBetweenNumbers, at), text.size());
    words.push_back({text.substr(at, end - at), line});
    at = end;
  }
  return words;
}

std::optional<double> number_of(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  return number_from<double>(word);
}

/// Returns whether a text is a matrix, not the name of a file: it then begins with two numbers.
bool is_matrix_text(const std::vector<Word>& words) {
  return words.size() > 1 && number_of(words[0].text) && number_of(words[1].text);
}

}  // namespace

Vec3 AffineMap::turned(Vec3 v) const {
  return {dot(linear_part(rows[0]), v), dot(linear_part(rows[1]), v), dot(linear_part(rows[2]), v)};
}

Vec3 AffineMap::moved(Vec3 p) const {
  const Vec3 v = turned(p);
  return {v.x + rows[0][3], v.y + rows[1][3], v.z + rows[2][3]};
}

Vec3 AffineMap::turned_by_transpose(Vec3 v) const {
  const auto column = [&](std::size_t c) { return Vec3{rows[0][c], rows[1][c], rows[2][c]}; };
  return {dot(column(0), v), dot(column(1), v), dot(column(2), v)};
}

AffineMap AffineMap::inverse(const std::string& place) const {
  const Vec3 a = linear_part(rows[0]), b = linear_part(rows[1]), c = linear_part(rows[2]);
  const auto unit = [](Vec3 v) { return 1 / std::hypot(v.x, v.y, v.z) * v; };
  const Vec3 columns[] = {cross(b, c), cross(c, a), cross(a, b)};
  const double determinant = dot(a, columns[0]);
  if (!(std::abs(dot(unit(a), cross(unit(b), unit(c)))) > kLeastDeterminant))
    fail_usage(
        "{}: the matrix is singular: it takes different points to the same place; check its numbers, none of the first "
        "three rows follows from the others.",
        place);
  if (!std::isnormal(determinant))
    fail_usage("{}: the determinant of the matrix is {}, outside of the range of double precision; scale in two steps.",
               place, determinant);
  AffineMap back;
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 3; ++column)
      back.rows[row][column] = columns[column][static_cast<int>(row)] / determinant;
  const Vec3 t = back.turned({rows[0][3], rows[1][3], rows[2][3]});
  back.rows[0][3] = 0.0 - t.x, back.rows[1][3] = 0.0 - t.y, back.rows[2][3] = 0.0 - t.z;
  return back;
}

AffineMap affine_map_of(const std::string& text_or_file, const std::string& place) {
  std::vector<Word> words = words_of_matrix(text_or_file);
  const bool is_file = !is_matrix_text(words);
  const std::string content = is_file ? read_text_file(text_or_file, "a matrix of 4 rows of 4 numbers") : "";
  if (is_file) words = words_of_matrix(content);
  const auto refuse = [&](std::optional<std::size_t> line, const std::string& what) {
    if (!is_file) fail_usage("{}: {}; {}.", place, what, kRemedy);
    fail("{}{}: {}; {}.", text_or_file, line ? fmt::format(":{}", *line) : "", what, kRemedy);
  };
  std::vector<double> numbers;
  for (const Word& word : words) {
    const std::optional<double> number = number_of(word.text);
    if (!number || !std::isfinite(*number)) refuse(word.line, fmt::format("'{}' is no finite number", word.text));
    numbers.push_back(*number);
  }
  if (numbers.size() != 12 && numbers.size() != 16) refuse({}, fmt::format("there are {} numbers", numbers.size()));
  if (numbers.size() == 16 && !(numbers[12] == 0 && numbers[13] == 0 && numbers[14] == 0 && numbers[15] == 1)) {
    const bool is_transposed = numbers[3] == 0 && numbers[7] == 0 && numbers[11] == 0 && numbers[15] == 1;
    refuse(words[12].line,
           fmt::format("the last row is {} {} {} {}, not 0 0 0 1{}", numbers[12], numbers[13], numbers[14], numbers[15],
                       is_transposed ? " (if the matrix is written by columns, transpose it)"
                                     : ", so the matrix is a projection, which does not keep planes "
                                       "and distances in proportion"));
  }
  AffineMap map;
  for (std::size_t n = 0; n < 12; ++n) map.rows[n / 4][n % 4] = numbers[n];
  return map;
}

}  // namespace pointsweep
