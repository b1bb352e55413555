// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "pointsweep/fail.h"
#include "pointsweep/formats/files/line_reader.h"
#include "pointsweep/formats/files/number_text.h"
#include "pointsweep/formats/las_scale.h"
#include "pointsweep/formats/ply/ply_format.h"
#include "pointsweep/formats/provenance.h"
#include "pointsweep/formats/records/record_readers.h"
#include "pointsweep/points/with_type.h"
#include "pointsweep/storage/local/input_file.h"

namespace pointsweep {
namespace {

[[noreturn]] void fail_inside(const std::filesystem::path& path, const PlyElement& element) {
  fail("{}: the file ends inside element '{}', which the header gives {} entries; it is truncated or its header lies.",
       path.string(), element.name, element.count);
}

/// Reads small pieces of a file at ascending offsets, through a buffer.
class ForwardBytes {
 public:
  ForwardBytes(const InputFile& file, std::uint64_t offset) : file_(file), block_(256 << 10), offset_(offset) {}

  std::uint64_t offset() const { return offset_; }
  void skip(std::uint64_t bytes) { offset_ += bytes; }
  /// Returns the next `size` <= 8 bytes, or null if the file ends before their end.
  const std::byte* take(std::size_t size) {
    if (offset_ < block_offset_ || offset_ + size > block_offset_ + filled_) {
      block_offset_ = offset_;
      filled_ = file_.read_some(offset_, block_);
      if (filled_ < size) return nullptr;
    }
    const std::byte* at = block_.data() + (offset_ - block_offset_);
    offset_ += size;
    return at;
  }

 private:
  const InputFile& file_;
  std::vector<std::byte> block_;
  std::uint64_t offset_;
  std::uint64_t block_offset_ = 0;
  std::size_t filled_ = 0;
};

/// Returns the number of items of the list that starts at the position of `walker`. Moves `walker` past the number.
std::uint64_t take_count(ForwardBytes& walker, const PlyProperty& list, bool big_endian,
                         const std::filesystem::path& path, const PlyElement& element) {
  Field field;
  field.type = list.count_type;
  std::array<std::byte, 8> bytes{};
  const std::size_t size = size_of(field.type);
  const std::byte* at = walker.take(size);
  if (at == nullptr) fail_inside(path, element);
  std::copy_n(at, size, bytes.begin());
  if (big_endian) std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
  const double count = value_of(field, bytes.data());
  if (count < 0) {
    fail("{}: byte {}: a list of element '{}' has {} items; the file is damaged.", path.string(),
         walker.offset() - size, element.name, count);
  }
  // More items than any file has bytes count as 2^50 items: the list ends after the end of the file in any case.
  return count < 1e15 ? static_cast<std::uint64_t>(count) : std::uint64_t{1} << 50;
}

/// Returns the offset of the first byte after a binary element that starts at `offset`. Reads the lengths of all lists
/// if the element has lists. Throws Error if the file ends within the element.
std::uint64_t end_of_binary_element(const InputFile& file, const PlyElement& element, PlyEncoding encoding,
                                    std::uint64_t offset) {
  if (!element.has_list()) {
    const std::uint64_t stride = element.stride(), room = file.size() - offset;
    if (stride != 0 && element.count > room / stride) fail_inside(file.path(), element);
    return offset + element.count * stride;
  }
  ForwardBytes walker(file, offset);
  for (std::uint64_t i = 0; i < element.count; ++i) {
    for (const PlyProperty& property : element.properties) {
      const std::uint64_t items =
          property.is_list ? take_count(walker, property, encoding == PlyEncoding::big_endian, file.path(), element)
                           : 1;
      walker.skip(items * size_of(property.type));
      if (walker.offset() > file.size()) fail_inside(file.path(), element);
    }
  }
  return walker.offset();
}

bool is_ply_row(std::string_view line) { return !is_blank(line); }

/// Moves `lines` past the lines of an ascii element. Throws Error if the file ends inside.
void skip_ascii_element(LineReader& lines, const PlyElement& element) {
  if (element.properties.empty()) return;
  for (std::uint64_t i = 0; i < element.count;) {
    const auto line = lines.next();
    if (!line) fail_inside(lines.file().path(), element);
    if (is_ply_row(*line)) ++i;
  }
}

static_assert(std::endian::native == std::endian::little, "records are the bytes of little-endian files");

[[noreturn]] void fail_truncated(const InputFile& file, std::uint64_t expected, std::uint64_t found) {
  fail(
      "{}: the header says {} vertices, but the file ends after {}; it is truncated or its header lies, so get the "
      "whole file or correct the line 'element vertex'.",
      file.path().string(), expected, found);
}

/// Returns the facts that the header of a file of any encoding states, except the number of points.
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

class BinaryPlyReader final : public ColumnsReader {
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
    for (const Field& field : info_.schema.fields) {
      const std::string_view word = take_word(line);
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
    if (!is_blank(line))
      complain(number, fmt::format("has more than the {} values of a vertex", info_.schema.fields.size()));
  }

 private:
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
