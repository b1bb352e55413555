// SPDX-License-Identifier: MIT
#include "pointsweep/formats/npy/npy_reader.h"

#include <algorithm>
#include <charconv>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/fail.h"
#include "pointsweep/formats/files/input_file.h"
#include "pointsweep/formats/fixed_records.h"

namespace pointsweep {
namespace {

constexpr std::size_t kMostHeader = 4096;
constexpr std::uint64_t kMostColumns = 1 << 16;

class NpyReader final : public FixedRecordReader {
 public:
  explicit NpyReader(const std::filesystem::path& path) : file_(std::make_shared<const InputFile>(path)) {
    info_.path = path;
    info_.format = "NumPy array";
    info_.bytes = file_->size();
    const std::string header = read_header();
    const Type type = type_of(value_after(header, "'descr'"));
    if (value_after(header, "'fortran_order'") != "False") fail("{}: is in Fortran order; save it in C order.", name());
    take_shape(value_after(header, "'shape'"), type);
    has_records(file_, data_);
  }

 private:
  std::string name() const { return info_.path.string(); }

  std::string read_header() {
    std::string head(kMostHeader, '\0');
    head.resize(file_->read_some(0, std::as_writable_bytes(std::span(head))));
    const auto byte = [&](std::size_t i) { return static_cast<std::size_t>(static_cast<unsigned char>(head[i])); };
    if (head.size() < 12 || !head.starts_with("\x93NUMPY")) fail("{}: is no NumPy array.", name());
    const std::size_t prefix = byte(6) == 1 ? 10 : 12;
    const std::size_t length = byte(8) | byte(9) << 8 | (prefix == 12 ? byte(10) << 16 | byte(11) << 24 : 0);
    if (length > head.size() - prefix) fail("{}: its header is cut off or too long; it is damaged.", name());
    data_ = prefix + length;
    return head.substr(prefix, length);
  }

  /// What follows `key` and a colon, up to the comma that ends it.
  std::string_view value_after(const std::string& header, std::string_view key) const {
    const std::size_t at = header.find(key);
    if (at == std::string::npos) fail("{}: its header has no {}; it is damaged.", name(), key);
    std::string_view rest = std::string_view(header).substr(at + key.size());
    rest.remove_prefix(std::min(rest.find_first_not_of(": "), rest.size()));
    const std::size_t end = rest.starts_with('(') ? rest.find(')') : rest.find_first_of(",}");
    return rest.substr(0, end);
  }

  Type type_of(std::string_view description) const {
    if (description == "'<u4'") return Type::u32;
    if (description == "'<u8'") return Type::u64;
    if (description == "'<f8'") return Type::f64;
    fail("{}: holds {}, which is neither neighbours ('<u4' or '<u8') nor distances ('<f8').", name(), description);
  }

  void take_shape(std::string_view shape, Type type) {
    const std::vector<std::uint64_t> sizes = sizes_of(shape);
    const std::uint64_t columns = sizes.size() < 2 ? 1 : sizes[1];
    if (sizes.empty() || sizes.size() > 2 || columns == 0 || columns > kMostColumns)
      fail("{}: its shape {}) is not that of rows of neighbours.", name(), shape);
    info_.count = sizes[0];
    const std::uint64_t row = columns * size_of(type), there = file_->size() - data_;
    if (there / row != info_.count || there % row != 0)
      fail("{}: its header speaks of {} rows of {} bytes, but {} bytes follow; it is damaged.", name(), info_.count,
           row, there);
    for (std::uint64_t c = 0; c < columns; ++c)
      info_.schema.append(fmt::format("{}_{}", type == Type::f64 ? "distance" : "neighbor", c), type);
  }

  /// The whole numbers in "(4000, 8": none if one of them is too large for any file.
  static std::vector<std::uint64_t> sizes_of(std::string_view shape) {
    std::vector<std::uint64_t> sizes;
    while (!shape.empty()) {
      std::uint64_t size = 0;
      const auto parsed = std::from_chars(shape.data(), shape.data() + shape.size(), size);
      if (parsed.ec == std::errc::result_out_of_range) return {};
      if (parsed.ec == std::errc{}) sizes.push_back(size);
      shape.remove_prefix(std::max<std::size_t>(1, static_cast<std::size_t>(parsed.ptr - shape.data())));
    }
    return sizes;
  }

  std::shared_ptr<const InputFile> file_;
  std::uint64_t data_ = 0;  ///< offset of row 0
};

}  // namespace

std::unique_ptr<Reader> open_npy(const std::filesystem::path& path) { return std::make_unique<NpyReader>(path); }

}  // namespace pointsweep
