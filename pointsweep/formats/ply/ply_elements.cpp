// SPDX-License-Identifier: MIT
#include "pointsweep/formats/ply/ply_elements.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <vector>

#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

[[noreturn]] void fail_inside(const std::filesystem::path& path, const PlyElement& element) {
  fail("{}: the file ends inside element '{}', which the header gives {} entries; it is truncated or its header lies.",
       path.string(), element.name, element.count);
}

/// Small reads at growing offsets, through a buffer.
class ForwardBytes {
 public:
  ForwardBytes(const InputFile& file, std::uint64_t offset) : file_(file), block_(256 << 10), offset_(offset) {}

  std::uint64_t offset() const { return offset_; }
  void skip(std::uint64_t bytes) { offset_ += bytes; }
  /// `size` <= 8 bytes, or null where the file ends before.
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

/// Returns the number of items of the list that starts at the walker's place; moves the walker past this number.
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
  // A list of more items than a file has bytes ends after the end of any file, whatever its exact number is.
  return count < 1e15 ? static_cast<std::uint64_t>(count) : std::uint64_t{1} << 50;
}

}  // namespace

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

void skip_ascii_element(LineReader& lines, const PlyElement& element) {
  if (element.properties.empty()) return;
  for (std::uint64_t i = 0; i < element.count;) {
    const auto line = lines.next();
    if (!line) fail_inside(lines.file().path(), element);
    if (is_ply_row(*line)) ++i;
  }
}

bool is_ply_row(std::string_view line) { return line.find_first_not_of(" \t\r\v\f") != line.npos; }

}  // namespace pointsweep
