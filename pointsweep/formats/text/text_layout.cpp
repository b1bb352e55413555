// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "pointsweep/fail.h"
#include "pointsweep/formats/field_names.h"
#include "pointsweep/formats/files/line_reader.h"
#include "pointsweep/formats/files/number_text.h"
#include "pointsweep/formats/provenance.h"
#include "pointsweep/formats/text/text_format.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/points/text_file.h"

namespace pointsweep {
namespace {

bool is_quote(char c) { return c == '"' || c == '\''; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

/// Returns the offset of the first character from `at` on, outside of quotes, for which `ends` is true; the size of the
/// line if there is none.
template <class Predicate>
std::size_t find_unquoted(std::string_view line, std::size_t at, Predicate ends) {
  char quote = 0;
  for (; at < line.size(); ++at) {
    if (quote != 0) {
      if (line[at] == quote) quote = 0;
    } else if (ends(line[at])) {
      return at;
    } else if (is_quote(line[at])) {
      quote = line[at];
    }
  }
  return line.size();
}

std::string_view cell_of(std::string_view text) {
  text = trimmed(text);
  if (text.size() < 2 || !is_quote(text.front()) || text.back() != text.front()) return text;
  return trimmed(text.substr(1, text.size() - 2));
}

bool is_word(std::string_view word, std::string_view lower_case) {
  return std::equal(word.begin(), word.end(), lower_case.begin(), lower_case.end(),
                    [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; });
}

constexpr std::size_t kRowsLookedAt = 100;

using Cells = std::vector<std::string_view>;

bool all_numbers(const Cells& cells) {
  double ignored = 0;
  return std::ranges::all_of(cells, [&](std::string_view cell) { return parse_cell(cell, ignored); });
}

bool names_a_point(const Cells& cells) {
  Schema schema;
  for (const std::string_view cell : cells) schema.append(std::string(cell), Type::f64);
  return schema.find("x") && schema.find("y") && schema.find("z");
}

std::vector<std::string> copies_of(const Cells& cells) { return {cells.begin(), cells.end()}; }

/// Reads the first lines of a file.
class LayoutFinder {
 public:
  LayoutFinder(const InputFile& file, std::span<const std::string> stated)
      : file_(file), lines_(file), stated_(stated) {}

  TextLayout run() {
    while (const auto line = next_line()) {
      if (!is_text_row(*line)) {
        look_at_comment(*line);
        continue;
      }
      split_cells(*line, separator_of(*line), cells_);
      if (!all_numbers(cells_) && !has_number(cells_, stated_)) {
        take_header();
        break;
      }
      if (!take_count()) {
        lines_.jump(line_offset_, lines_.line());
        break;
      }
    }
    layout_.body_offset = lines_.offset();
    layout_.body_line = lines_.next_line();
    look_at_rows();
    find_types();
    return std::move(layout_);
  }

 private:
  std::optional<std::string_view> next_line() {
    line_offset_ = lines_.offset();
    const auto line = lines_.next();
    if (!line || line_offset_ != 0 || !line->starts_with(kByteOrderMark)) return line;
    line_offset_ = kByteOrderMark.size();
    return line->substr(kByteOrderMark.size());
  }

  void look_at_comment(std::string_view line) {
    const std::string_view comment = comment_of(line);
    if (auto provenance = provenance_line(comment)) return layout_.provenance.push_back(std::move(*provenance));
    split_cells(comment, separator_of(comment), cells_);
    if (names_a_point(cells_)) comment_names_ = copies_of(cells_);
  }

  void take_header() {
    if (stated_.empty() && !names_a_point(cells_)) {
      fail(
          "{}: line {} is neither numbers nor a header that names x, y and z; this is no text file of points, or its "
          "columns need a header or names (--columns x,y,z,...).",
          file_.path().string(), lines_.line());
    }
    layout_.names = copies_of(cells_);
    layout_.has_header = true;
  }

  bool take_count() {
    std::uint64_t count = 0;
    if (cells_.size() != 1 || layout_.announced || !parse_number(cells_[0], count)) return false;
    layout_.announced = count;
    return true;
  }

  /// Finds the separator and, without a header, the names.
  void look_at_rows() {
    std::vector<std::vector<double>> rows;
    while (rows.size() < kRowsLookedAt) {
      const auto line = lines_.next();
      if (!line) break;
      if (!is_text_row(*line)) {
        if (rows.empty()) look_at_comment(*line);
        continue;
      }
      if (layout_.announced && !is_pts_row(*line)) continue;
      if (rows.empty()) layout_.separator = separator_of(*line);
      split_cells(*line, layout_.separator, cells_);
      if (!stated_.empty()) break;
      if (rows.empty() && cells_.size() < 3) {
        fail("{}: line {} has {} {}; a point needs x, y and z.", file_.path().string(), lines_.line(), cells_.size(),
             cells_.size() == 1 ? "value" : "values");
      }
      std::vector<double> row(cells_.size());
      for (std::size_t i = 0; i < row.size(); ++i) {
        if (!parse_cell(cells_[i], row[i])) return use_names(rows);
      }
      if (!rows.empty() && row.size() != rows[0].size()) break;
      rows.push_back(std::move(row));
    }
    use_names(rows);
  }

  void use_names(const std::vector<std::vector<double>>& rows) {
    if (!stated_.empty()) return use_stated_names();
    if (layout_.has_header) return;
    if (!comment_names_.empty() && (rows.empty() || comment_names_.size() == rows[0].size())) {
      layout_.names = comment_names_;
      layout_.has_header = true;
    } else {
      layout_.names = default_column_names(rows);
    }
  }

  void use_stated_names() {
    layout_.replaced_names = layout_.has_header ? std::move(layout_.names) : std::move(comment_names_);
    layout_.names.assign(stated_.begin(), stated_.end());
    layout_.are_stated = true;
  }

  /// Reads the first rows once more, since columns with stated names are not read before.
  void find_types() {
    constexpr std::array kCandidates{Type::f64, Type::i64, Type::u64};
    const std::size_t columns = layout_.names.size();
    std::vector<std::array<bool, kCandidates.size()>> holds(columns, {true, true, true});
    LineReader lines(file_);
    lines.jump(layout_.body_offset, layout_.body_line);
    for (std::size_t rows = 0; rows < kRowsLookedAt;) {
      const auto line = lines.next();
      if (!line) break;
      if (layout_.announced ? !is_pts_row(*line) : !is_text_row(*line)) continue;
      ++rows;
      split_cells(*line, layout_.separator, cells_);
      for (std::size_t i = 0; i < std::min(columns, cells_.size()); ++i) {
        std::int64_t as_signed = 0;
        std::uint64_t as_unsigned = 0;
        holds[i][0] &= !needs_integer(cells_[i]);
        holds[i][1] &= parse_number(cells_[i], as_signed);
        holds[i][2] &= parse_number(cells_[i], as_unsigned);
      }
    }
    layout_.types.assign(columns, Type::f64);
    for (std::size_t i = 0; i < columns; ++i) {
      if (std::ranges::any_of(kAxisNames, [&](const char* axis) { return is_spelling_of(axis, layout_.names[i]); }))
        continue;
      const auto first = std::ranges::find(holds[i], true);
      if (first != holds[i].end()) layout_.types[i] = kCandidates[static_cast<std::size_t>(first - holds[i].begin())];
    }
  }

  const InputFile& file_;
  LineReader lines_;
  std::span<const std::string> stated_;
  TextLayout layout_;
  Cells cells_;
  std::vector<std::string> comment_names_;
  std::uint64_t line_offset_ = 0;
};

}  // namespace

Separator separator_of(std::string_view line) {
  const auto has = [&](char wanted) {
    return find_unquoted(line, 0, [=](char c) { return c == wanted; }) != line.size();
  };
  for (const Separator separator : {Separator::semicolon, Separator::bar, Separator::comma})
    if (has(static_cast<char>(separator))) return separator;
  return Separator::space;
}

void split_cells(std::string_view line, Separator separator, std::vector<std::string_view>& cells) {
  cells.clear();
  if (separator == Separator::space) {
    for (std::size_t at = 0;;) {
      while (at < line.size() && is_space(line[at])) ++at;
      if (at == line.size()) return;
      const std::size_t end = find_unquoted(line, at, is_space);
      cells.push_back(cell_of(line.substr(at, end - at)));
      at = end;
    }
  }
  for (std::size_t at = 0; at <= line.size();) {
    const std::size_t end = find_unquoted(line, at, [=](char c) { return c == static_cast<char>(separator); });
    const std::string_view raw = line.substr(at, end - at);
    if (end == line.size() && raw.find_first_not_of(" \t\r\n") == raw.npos) return;
    cells.push_back(cell_of(raw));
    at = end + 1;
  }
}

bool is_text_row(std::string_view line) {
  std::size_t at = 0;
  while (at < line.size() && is_space(line[at])) ++at;
  if (at == line.size() || line[at] == '#' || line[at] == '%') return false;
  return !line.substr(at).starts_with("//");
}

bool is_pts_row(std::string_view line) {
  return is_text_row(line) && trimmed(line).find_first_of(" \t,;|") != line.npos;
}

std::string_view comment_of(std::string_view line) {
  line = trimmed(line);
  if (!line.starts_with('#') && !line.starts_with('%') && !line.starts_with("//")) return {};
  return trimmed(line.substr(std::min(line.find_first_not_of("#/%"), line.size())));
}

bool parse_cell(std::string_view cell, double& value) {
  if (parse_number(cell, value)) return true;
  if (!cell.empty() && !is_word(cell, "na") && !is_word(cell, "n/a") && !is_word(cell, "null")) return false;
  value = std::numeric_limits<double>::quiet_NaN();
  return true;
}

bool needs_integer(std::string_view cell) {
  const auto is_rounded = [](auto whole) {
    // A double of 2^64 or 2^63 is above the range of the type, and cannot be converted back.
    const auto nearest = static_cast<double>(whole);
    return nearest >= std::ldexp(1.0, std::numeric_limits<decltype(whole)>::digits) ||
           static_cast<decltype(whole)>(nearest) != whole;
  };
  const char *const begin = cell.data() + (cell.starts_with('+') ? 1 : 0), *const end = cell.data() + cell.size();
  std::uint64_t large = 0;
  std::int64_t whole = 0;
  if (std::from_chars(begin, end, large).ptr == end) return is_rounded(large);
  return std::from_chars(begin, end, whole).ptr == end && is_rounded(whole);
}

bool has_number(std::span<const std::string_view> cells, std::span<const std::string> columns) {
  double ignored = 0;
  for (std::size_t i = 0; i < std::min(cells.size(), columns.size()); ++i)
    if (columns[i] != kSkippedColumn && parse_cell(cells[i], ignored)) return true;
  return false;
}

TextLayout find_text_layout(const InputFile& file, std::span<const std::string> stated) {
  return LayoutFinder(file, stated).run();
}

}  // namespace pointsweep
