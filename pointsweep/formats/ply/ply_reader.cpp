// SPDX-License-Identifier: MIT
#include "pointsweep/formats/ply/ply_reader.h"

#include <algorithm>
#include <bit>

#include "pointsweep/error.h"
#include "pointsweep/formats/files/input_file.h"
#include "pointsweep/formats/files/number_text.h"
#include "pointsweep/formats/files/row_lines.h"
#include "pointsweep/formats/ply/ply_comments.h"
#include "pointsweep/formats/ply/ply_elements.h"
#include "pointsweep/formats/ply/ply_header.h"
#include "pointsweep/formats/provenance.h"
#include "pointsweep/points/with_type.h"

namespace pointsweep {
namespace {

static_assert(std::endian::native == std::endian::little, "records are the bytes of little-endian files");

[[noreturn]] void fail_truncated(const InputFile& file, std::uint64_t expected, std::uint64_t found) {
  fail(
      "{}: the header says {} vertices, but the file ends after {}; it is truncated or its header lies, so get the "
      "whole file or correct the line 'element vertex'.",
      file.path().string(), expected, found);
}

class PlyReader : public Reader {
 protected:
  PlyReader(std::unique_ptr<InputFile> file, const PlyHeader& header, const PlyElement& vertex)
      : file_(std::move(file)) {
    info_.path = file_->path();
    info_.format = fmt::format("PLY 1.0 {}", name_of(header.encoding));
    info_.bytes = file_->size();
    for (const PlyProperty& property : vertex.properties) info_.schema.append(property.name, property.type);
    for (const PlyElement& element : header.elements) {
      if (&element == &vertex || element.count == 0) continue;
      info_.warnings.push_back(fmt::format("{}: the {} entries of element '{}' are not kept in an output.",
                                           file_->path().string(), element.count, element.name));
    }
    auto extras = std::make_shared<PlyExtras>();
    extras->lines = header.remarks;
    info_.crs = take_crs_comments(extras->lines);
    info_.las = take_las_comment(extras->lines);
    for (const std::string& line : extras->lines)
      if (line.starts_with("comment"))
        if (auto found = provenance_line(line.substr(7))) extras->provenance.push_back(std::move(*found));
    info_.provenance = extras->provenance;
    info_.extras = std::move(extras);
    position_fields(info_.schema, file_->path().string());
  }

  std::unique_ptr<InputFile> file_;
};

class BinaryPlyReader final : public PlyReader {
 public:
  BinaryPlyReader(std::unique_ptr<InputFile> file, const PlyHeader& header, const PlyElement& vertex)
      : PlyReader(std::move(file), header, vertex),
        offset_(header.body_offset),
        swaps_(header.encoding == PlyEncoding::big_endian) {
    for (const PlyElement* element = header.elements.data(); element != &vertex; ++element) {
      offset_ = end_of_binary_element(*file_, *element, header.encoding, offset_);
    }
    const std::uint64_t found = (file_->size() - offset_) / info_.schema.stride;
    if (vertex.count > found) fail_truncated(*file_, vertex.count, found);
    info_.count = vertex.count;
  }

  std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
    const std::size_t rows = rows_for(row, records);
    if (rows == 0) return 0;
    const auto bytes = records.first(rows * info_.schema.stride);
    file_->read_at(offset_ + row * info_.schema.stride, bytes);
    if (swaps_) swap_bytes(info_.schema, bytes);
    return rows;
  }

 private:
  std::uint64_t offset_;
  bool swaps_;
};

class AsciiPlyReader final : public PlyReader {
 public:
  AsciiPlyReader(std::unique_ptr<InputFile> file, const PlyHeader& header, const PlyElement& vertex)
      : PlyReader(std::move(file), header, vertex), rows_(find_rows(*file_, header, vertex)) {
    if (rows_.count() < vertex.count) fail_truncated(*file_, vertex.count, rows_.count());
    info_.count = vertex.count;
  }

  std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
    const std::size_t rows = rows_for(row, records);
    for (std::size_t i = 0; i < rows; ++i) parse(rows_.at(row + i), records.data() + i * info_.schema.stride);
    if (row + rows == info_.count) rows_.rest();
    return rows;
  }

 private:
  static RowLines find_rows(const InputFile& file, const PlyHeader& header, const PlyElement& vertex) {
    LineReader lines(file);
    lines.jump(header.body_offset, header.body_line);
    for (const PlyElement* element = header.elements.data(); element != &vertex; ++element) {
      skip_ascii_element(lines, *element);
    }
    return RowLines(lines, is_ply_row, vertex.count);
  }

  void parse(std::string_view line, std::byte* record) const {
    std::size_t at = 0;
    for (const Field& field : info_.schema.fields) {
      const std::string_view word = take_word(line, at);
      if (word.empty()) complain(fmt::format("has fewer than the {} values of a vertex", info_.schema.fields.size()));
      const bool good = with_type(field.type, [&]<class T>() {
        T value{};
        if (!parse_number(word, value)) return false;
        std::copy_n(reinterpret_cast<const std::byte*>(&value), sizeof value, record + field.offset);
        return true;
      });
      if (!good) {
        complain(
            fmt::format("'{}' is no {} for the property '{}'", word.substr(0, 40), name_of(field.type), field.name));
      }
    }
    if (!take_word(line, at).empty()) {
      complain(fmt::format("has more than the {} values of a vertex", info_.schema.fields.size()));
    }
  }

  /// The next word of `line` from `at` on, empty at its end.
  static std::string_view take_word(std::string_view line, std::size_t& at) {
    const auto is_space = [](char c) { return c == ' ' || (c >= '\t' && c <= '\r'); };
    while (at < line.size() && is_space(line[at])) ++at;
    const std::size_t start = at;
    while (at < line.size() && !is_space(line[at])) ++at;
    return line.substr(start, at - start);
  }

  [[noreturn]] void complain(std::string_view what) const {
    fail("{}: line {}: {}; correct the line or the header.", file_->path().string(), rows_.line(), what);
  }

  RowLines rows_;
};

const PlyElement& vertex_of(const PlyHeader& header, const std::filesystem::path& path) {
  std::string names;
  for (const PlyElement& element : header.elements) {
    if (element.name != "vertex") {
      names += (names.empty() ? "" : ", ") + element.name;
      continue;
    }
    for (const PlyProperty& property : element.properties) {
      if (!property.is_list) continue;
      fail("{}: property '{}' gives each vertex a list, which a point cannot hold; write the file again without it.",
           path.string(), property.name);
    }
    return element;
  }
  fail("{}: has no element 'vertex' and so no points (elements found: {}).", path.string(),
       names.empty() ? "none" : names);
}

}  // namespace

std::unique_ptr<Reader> open_ply(const std::filesystem::path& path) {
  auto file = std::make_unique<InputFile>(path);
  const PlyHeader header = read_ply_header(*file);
  const PlyElement& vertex = vertex_of(header, path);
  if (header.encoding == PlyEncoding::ascii) return std::make_unique<AsciiPlyReader>(std::move(file), header, vertex);
  return std::make_unique<BinaryPlyReader>(std::move(file), header, vertex);
}

}  // namespace pointsweep
