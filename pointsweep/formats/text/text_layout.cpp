// SPDX-License-Identifier: MIT
#include "pointsweep/formats/text/text_layout.h"

#include <algorithm>

#include "pointsweep/fail.h"
#include "pointsweep/formats/default_columns.h"
#include "pointsweep/formats/files/line_reader.h"
#include "pointsweep/formats/files/number_text.h"
#include "pointsweep/formats/provenance.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {
namespace {

constexpr std::size_t kRowsLookedAt = 100;
constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

using Cells = std::vector<std::string_view>;

bool all_numbers(const Cells& cells) {
  double ignored = 0;
  return std::all_of(cells.begin(), cells.end(), [&](std::string_view cell) { return parse_cell(cell, ignored); });
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
  explicit LayoutFinder(const InputFile& file) : file_(file), lines_(file) {}

  TextLayout run() {
    while (const auto line = next_line()) {
      if (!is_text_row(*line)) {
        look_at_comment(*line);
        continue;
      }
      split_cells(*line, separator_of(*line), cells_);
      if (!all_numbers(cells_)) {
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
    if (!names_a_point(cells_)) {
      fail(
          "{}: line {} is neither numbers nor a header that names x, y and z; this is no text file of points, or its "
          "columns need a header.",
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

  /// The separator and, without a header, the names.
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
    if (layout_.has_header) return;
    if (!comment_names_.empty() && (rows.empty() || comment_names_.size() == rows[0].size())) {
      layout_.names = comment_names_;
      layout_.has_header = true;
    } else {
      layout_.names = default_column_names(rows);
    }
  }

  const InputFile& file_;
  LineReader lines_;
  TextLayout layout_;
  Cells cells_;
  std::vector<std::string> comment_names_;
  std::uint64_t line_offset_ = 0;
};

}  // namespace

TextLayout find_text_layout(const InputFile& file) { return LayoutFinder(file).run(); }

}  // namespace pointsweep
