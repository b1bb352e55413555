// SPDX-License-Identifier: MIT
#include "pointsweep/formats/text/text_reader.h"

#include <algorithm>
#include <limits>

#include "pointsweep/error.h"
#include "pointsweep/formats/files/input_file.h"
#include "pointsweep/formats/files/row_lines.h"
#include "pointsweep/formats/text/text_layout.h"

namespace pointsweep {
namespace {

std::string_view word_for(Separator separator) {
  switch (separator) {
    case Separator::comma:
      return "comma";
    case Separator::semicolon:
      return "semicolon";
    case Separator::space:
      break;
  }
  return "space";
}

class TextReader final : public Reader {
 public:
  explicit TextReader(std::unique_ptr<InputFile> file)
      : file_(std::move(file)), layout_(find_text_layout(*file_)), rows_(find_rows(*file_, layout_)) {
    info_.path = file_->path();
    info_.format = fmt::format("text, {} separated, {}", word_for(layout_.separator),
                               layout_.has_header ? "with header" : "without header");
    info_.bytes = file_->size();
    info_.count = rows_.count();
    info_.provenance = layout_.provenance;
    for (const std::string& name : layout_.names) info_.schema.append(name, Type::f64);
    if (layout_.announced && *layout_.announced != info_.count) {
      info_.warnings.push_back(fmt::format("{}: announces {} points but holds {}; all of them are read.",
                                           file_->path().string(), *layout_.announced, info_.count));
    }
  }

  std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
    const std::size_t rows = rows_for(row, records);
    for (std::size_t i = 0; i < rows; ++i) parse(rows_.at(row + i), records.data() + i * info_.schema.stride);
    if (rows != 0 && row + rows == info_.count) rows_.rest();
    return rows;
  }

 private:
  static RowLines find_rows(const InputFile& file, const TextLayout& layout) {
    LineReader lines(file);
    lines.jump(layout.body_offset, layout.body_line);
    return RowLines(lines, is_text_row, std::numeric_limits<std::uint64_t>::max());
  }

  void parse(std::string_view line, std::byte* record) {
    split_cells(line, layout_.separator, cells_);
    const std::size_t columns = layout_.names.size();
    // An empty last cell looks like a trailing separator.
    if (cells_.size() + 1 == columns && layout_.separator != Separator::space) cells_.emplace_back();
    if (cells_.size() != columns) {
      fail("{}: line {} has {} values where {} are expected ({}); correct the line.", file_->path().string(),
           rows_.line(), cells_.size(), columns, layout_.has_header ? "as in the header" : "as in the first row");
    }
    for (std::size_t i = 0; i < columns; ++i) {
      double value = 0;
      if (!parse_cell(cells_[i], value)) {
        fail("{}: line {}: '{}' in column '{}' is no number; correct it or write nan.", file_->path().string(),
             rows_.line(), cells_[i].substr(0, 40), layout_.names[i]);
      }
      std::copy_n(reinterpret_cast<const std::byte*>(&value), sizeof value, record + i * sizeof value);
    }
  }

  std::unique_ptr<InputFile> file_;
  TextLayout layout_;
  RowLines rows_;
  std::vector<std::string_view> cells_;
};

}  // namespace

std::unique_ptr<Reader> open_text(const std::filesystem::path& path) {
  return std::make_unique<TextReader>(std::make_unique<InputFile>(path));
}

}  // namespace pointsweep
