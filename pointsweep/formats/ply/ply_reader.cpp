// SPDX-License-Identifier: MIT
#include "pointsweep/formats/ply/ply_reader.h"

#include <algorithm>
#include <bit>

#include "pointsweep/fail.h"
#include "pointsweep/formats/files/input_file.h"
#include "pointsweep/formats/files/number_text.h"
#include "pointsweep/formats/las_origin.h"
#include "pointsweep/formats/ply/ply_comments.h"
#include "pointsweep/formats/ply/ply_elements.h"
#include "pointsweep/formats/ply/ply_header.h"
#include "pointsweep/formats/provenance.h"
#include "pointsweep/formats/records/fixed_records.h"
#include "pointsweep/formats/records/row_text_reader.h"
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

/// Returns the facts in the header of a file of either encoding.
FileInfo info_of(const InputFile& file, const PlyHeader& header, const PlyElement& vertex) {
  FileInfo info;
  info.path = file.path();
  info.format = fmt::format("PLY 1.0 {}", name_of(header.encoding));
  info.bytes = file.size();
  for (const PlyProperty& property : vertex.properties) info.schema.append(property.name, property.type);
  for (const PlyElement& element : header.elements) {
    if (&element == &vertex || element.count == 0) continue;
    info.warnings.push_back(fmt::format("{}: the {} entries of element '{}' are not kept in an output.",
                                        file.path().string(), element.count, element.name));
  }
  auto extras = std::make_shared<PlyExtras>();
  extras->lines = header.remarks;
  info.crs = take_crs_comments(extras->lines);
  if (const auto origin = take_las_comment(extras->lines)) info.las = std::make_shared<const LasOrigin>(*origin);
  for (const std::string& line : extras->lines)
    if (line.starts_with("comment"))
      if (auto found = provenance_line(line.substr(7))) extras->provenance.push_back(std::move(*found));
  info.provenance = extras->provenance;
  info.extras = std::move(extras);
  position_fields(info.schema, file.path().string());
  return info;
}

class BinaryPlyReader final : public FixedRecordReader {
 public:
  BinaryPlyReader(std::shared_ptr<const InputFile> file, const PlyHeader& header, const PlyElement& vertex) {
    info_ = info_of(*file, header, vertex);
    std::uint64_t offset = header.body_offset;
    for (const PlyElement* element = header.elements.data(); element != &vertex; ++element) {
      offset = end_of_binary_element(*file, *element, header.encoding, offset);
    }
    const std::uint64_t found = (file->size() - offset) / info_.schema.stride;
    if (vertex.count > found) fail_truncated(*file, vertex.count, found);
    info_.count = vertex.count;
    const bool big_endian = header.encoding == PlyEncoding::big_endian;
    has_records(std::move(file), offset, big_endian ? info_.schema.fields : std::vector<Field>{});
  }
};

class PlyLineParser final : public LineParser {
 public:
  explicit PlyLineParser(const FileInfo& info) : info_(info) {}

  void parse(std::string_view line, std::uint64_t number, std::byte* record) override {
    std::size_t at = 0;
    for (const Field& field : info_.schema.fields) {
      const std::string_view word = take_word(line, at);
      if (word.empty())
        complain(number, fmt::format("has fewer than the {} values of a vertex", info_.schema.fields.size()));
      const bool good = with_type(field.type, [&]<class T>() {
        T value{};
        if (!parse_number(word, value)) return false;
        std::copy_n(reinterpret_cast<const std::byte*>(&value), sizeof value, record + field.offset);
        return true;
      });
      if (!good)
        complain(number, fmt::format("'{}' is no {} for the property '{}'", word.substr(0, 40), name_of(field.type),
                                     field.name));
    }
    if (!take_word(line, at).empty())
      complain(number, fmt::format("has more than the {} values of a vertex", info_.schema.fields.size()));
  }

 private:
  /// The next word of `line` from `at` on, empty at its end.
  static std::string_view take_word(std::string_view line, std::size_t& at) {
    const auto is_space = [](char c) { return c == ' ' || (c >= '\t' && c <= '\r'); };
    while (at < line.size() && is_space(line[at])) ++at;
    const std::size_t start = at;
    while (at < line.size() && !is_space(line[at])) ++at;
    return line.substr(start, at - start);
  }

  [[noreturn]] void complain(std::uint64_t number, std::string_view what) const {
    fail("{}: line {}: {}; correct the line or the header.", info_.path.string(), number, what);
  }

  const FileInfo& info_;
};

class AsciiPlyReader final : public RowTextReader {
 public:
  AsciiPlyReader(std::unique_ptr<const InputFile> file, const PlyHeader& header, const PlyElement& vertex) {
    file_ = std::move(file);
    info_ = info_of(*file_, header, vertex);
    LineReader lines(*file_);
    lines.jump(header.body_offset, header.body_line);
    for (const PlyElement* element = header.elements.data(); element != &vertex; ++element) {
      skip_ascii_element(lines, *element);
    }
    rows_.emplace(lines, is_ply_row, vertex.count);
    if (rows_->count() < vertex.count) fail_truncated(*file_, vertex.count, rows_->count());
    info_.count = vertex.count;
  }

 private:
  std::unique_ptr<LineParser> parser() const override { return std::make_unique<PlyLineParser>(info_); }
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
