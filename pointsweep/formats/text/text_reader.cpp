// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "pointsweep/fail.h"
#include "pointsweep/formats/files/number_text.h"
#include "pointsweep/formats/records/record_readers.h"
#include "pointsweep/formats/text/text_format.h"
#include "pointsweep/storage/local/input_file.h"

namespace pointsweep {
namespace {

std::string_view word_for(Separator separator) {
  switch (separator) {
    case Separator::comma:
      return "comma";
    case Separator::semicolon:
      return "semicolon";
    case Separator::bar:
      return "bar";
    case Separator::space:
      break;
  }
  return "space";
}

class TextLineParser final : public LineParser {
 public:
  TextLineParser(const std::filesystem::path& path, const TextLayout& layout) : path_(path), layout_(layout) {}

  void parse(std::string_view line, std::uint64_t number, std::byte* record) override {
    split_cells(line, layout_.separator, cells_);
    const std::size_t columns = layout_.names.size();
    // split_cells() drops an empty last cell, which looks like a trailing separator.
    const std::size_t end = line.find_last_not_of(" \t\r\n");
    if (cells_.size() + 1 == columns && layout_.separator != Separator::space && end != line.npos &&
        line[end] == static_cast<char>(layout_.separator))
      cells_.emplace_back();
    if (cells_.size() != columns) {
      fail("{}: line {} has {} values where {} are expected ({}); correct the line.", path_.string(), number,
           cells_.size(), columns,
           layout_.are_stated   ? "as --columns names"
           : layout_.has_header ? "as in the header"
                                : "as in the first row");
    }
    for (std::size_t i = 0; i < columns; ++i) {
      if (layout_.are_stated && layout_.names[i] == kSkippedColumn) continue;
      switch (layout_.types[i]) {
        case Type::i64:
          record = store(whole<std::int64_t>(i, number), record);
          break;
        case Type::u64:
          record = store(whole<std::uint64_t>(i, number), record);
          break;
        default:
          record = store(real(i, number), record);
      }
    }
  }

 private:
  template <class T>
  static std::byte* store(T value, std::byte* record) {
    return std::copy_n(reinterpret_cast<const std::byte*>(&value), sizeof value, record);
  }

  double real(std::size_t column, std::uint64_t line) const {
    double value = 0;
    if (!parse_cell(cells_[column], value)) fail_in(column, line, "is no number; correct it or write nan");
    if (std::abs(value) >= 0x1p53 && needs_integer(cells_[column])) {
      fail_in(column, line,
              "cannot be held by float64, the type that the first rows give the column; leave the column out, by '-' "
              "in its place of --columns, or write 64-bit integers in all rows");
    }
    return value;
  }

  template <class T>
  T whole(std::size_t column, std::uint64_t line) const {
    T value = 0;
    if (!parse_number(cells_[column], value)) {
      fail_in(column, line,
              fmt::format("cannot be held by {}, the type that the 64-bit integers of the first rows give the column; "
                          "correct it, or leave the column out, by '-' in its place of --columns",
                          std::is_signed_v<T> ? "int64" : "uint64"));
    }
    return value;
  }

  [[noreturn]] void fail_in(std::size_t column, std::uint64_t line, std::string_view what) const {
    fail("{}: line {}: '{}' in column '{}' {}.", path_.string(), line, cells_[column].substr(0, 40),
         layout_.names[column], what);
  }

  const std::filesystem::path& path_;
  const TextLayout& layout_;
  std::vector<std::string_view> cells_;
};

class TextReader final : public RowTextReader {
 public:
  TextReader(const std::filesystem::path& path, std::span<const std::string> columns) {
    file_ = std::make_unique<const InputFile>(path);
    layout_ = find_text_layout(*file_, columns);
    LineReader lines(*file_);
    lines.jump(layout_.body_offset, layout_.body_line);
    find_rows(lines);
    info_.path = path;
    info_.format = fmt::format("text, {} separated, {}", word_for(layout_.separator),
                               layout_.are_stated   ? "columns as stated"
                               : layout_.has_header ? "with header"
                                                    : "without header");
    if (layout_.are_stated) info_.asked_for_as = fmt::format("text:{}", fmt::join(layout_.names, ","));
    info_.bytes = file_->size();
    info_.count = rows_->count();
    info_.provenance = layout_.provenance;
    for (std::size_t i = 0; i < layout_.names.size(); ++i) {
      if (!layout_.are_stated || layout_.names[i] != kSkippedColumn)
        info_.schema.append(layout_.names[i], layout_.types[i]);
    }
    if (!layout_.replaced_names.empty() && layout_.replaced_names != layout_.names)
      info_.warnings.push_back(fmt::format("{}: --columns replaces the names of its header ({}).",
                                           file_->path().string(), fmt::join(layout_.replaced_names, ",")));
    if (layout_.announced && *layout_.announced != info_.count) {
      info_.warnings.push_back(fmt::format("{}: announces {} points but holds {}; all of them are read.",
                                           file_->path().string(), *layout_.announced, info_.count));
    }
  }

 private:
  /// Finds the rows. A PTS file that states the number of rows may state a number again before the rows of another
  /// scan.
  void find_rows(const LineReader& lines) {
    constexpr std::uint64_t kAll = std::numeric_limits<std::uint64_t>::max();
    if (!layout_.announced) return void(rows_.emplace(lines, is_text_row, kAll));
    rows_.emplace(lines, is_pts_row, kAll, [&](std::string_view line, std::uint64_t number, std::uint64_t rows) {
      if (!is_text_row(line)) return;
      std::uint64_t count = 0;
      std::vector<std::string_view> cells;
      split_cells(line, Separator::space, cells);
      if (rows < *layout_.announced || !parse_number(cells[0], count))
        fail(
            "{}: line {} has 1 value; a point needs x, y and z, and the number of points of another scan stands after "
            "the points before it, of which there are {} of {}.",
            file_->path().string(), number, rows, *layout_.announced);
      *layout_.announced += count;
    });
  }

  std::unique_ptr<LineParser> parser() const override { return std::make_unique<TextLineParser>(info_.path, layout_); }

  TextLayout layout_;
};

}  // namespace

bool fits_text(const std::filesystem::path& path, std::span<const std::string> columns) {
  try {
    const InputFile file(path);
    const TextLayout layout = find_text_layout(file, columns);
    LineReader lines(file);
    lines.jump(layout.body_offset, layout.body_line);
    while (const auto line = lines.next()) {
      if (!is_text_row(*line)) continue;
      std::vector<std::string_view> cells;
      split_cells(*line, layout.separator, cells);
      return columns.empty() || has_number(cells, columns);
    }
    return layout.has_header && columns.empty();
  } catch (const Error&) {
    return false;
  }
}

std::unique_ptr<Reader> open_text(const std::filesystem::path& path) { return open_text_columns(path, {}); }

std::unique_ptr<Reader> open_text_columns(const std::filesystem::path& path, std::span<const std::string> columns) {
  return std::make_unique<TextReader>(path, columns);
}

}  // namespace pointsweep
