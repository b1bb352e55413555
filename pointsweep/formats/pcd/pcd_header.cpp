// SPDX-License-Identifier: MIT
#include <optional>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/formats/files/line_reader.h"
#include "pointsweep/formats/files/number_text.h"
#include "pointsweep/formats/pcd/pcd_format.h"
#include "pointsweep/formats/provenance.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kMostHeaderLines = 32768;  ///< more than all lines of provenance
constexpr std::uint32_t kMostBytes = 1u << 20;     ///< largest size of a record

std::optional<Type> type_of(std::string_view kind, std::uint64_t size) {
  const auto among = [&](Type one, Type two, Type four, Type eight) -> std::optional<Type> {
    return size == 1   ? std::optional(one)
           : size == 2 ? std::optional(two)
           : size == 4 ? std::optional(four)
           : size == 8 ? std::optional(eight)
                       : std::nullopt;
  };
  if (kind == "I") return among(Type::i8, Type::i16, Type::i32, Type::i64);
  if (kind == "U") return among(Type::u8, Type::u16, Type::u32, Type::u64);
  if (kind != "F" || size < 4) return std::nullopt;
  return among(Type::u8, Type::u16, Type::f32, Type::f64);
}

class HeaderParser {
 public:
  explicit HeaderParser(const InputFile& file) : file_(file), lines_(file) {}

  PcdHeader parse() {
    while (!has_data_) {
      const std::optional<std::string_view> line = lines_.next();
      if (!line || lines_.line() > kMostHeaderLines)
        fail("{}: is a PCD file without the line DATA, which ends its header; get the whole file.", name());
      take(words_in(*line), *line);
    }
    make_fields();
    if (!points_) points_ = header_.width * header_.height;
    header_.points = *points_;
    header_.body_offset = lines_.offset();
    header_.body_line = lines_.next_line();
    return std::move(header_);
  }

 private:
  std::string name() const { return file_.path().string(); }
  [[noreturn]] void complain(std::string_view what) const {
    fail("{}: line {} of the PCD header: {}; correct it or write the file again.", name(), lines_.line(), what);
  }

  void take(const std::vector<std::string_view>& words, std::string_view line) {
    if (words.empty()) return;
    if (words[0].starts_with('#')) {
      if (auto found = provenance_line(line.substr(line.find('#') + 1)))
        header_.provenance.push_back(std::move(*found));
      return;
    }
    const std::string_view key = words[0];
    const std::vector<std::string_view> values(words.begin() + 1, words.end());
    if (key == "FIELDS" || key == "COLUMNS") names_.assign(values.begin(), values.end());
    if (key == "SIZE") sizes_ = numbers(values);
    if (key == "TYPE") types_.assign(values.begin(), values.end());
    if (key == "COUNT") counts_ = numbers(values);
    if (key == "WIDTH") header_.width = number(values);
    if (key == "HEIGHT") header_.height = number(values);
    if (key == "POINTS") points_ = number(values);
    if (key == "VIEWPOINT") header_.viewpoint = line.substr(0, line.find_last_not_of(" \t\r") + 1);
    if (key == "DATA") take_data(values);
  }

  void take_data(const std::vector<std::string_view>& values) {
    const std::string_view word = values.empty() ? "" : values[0];
    if (word != "ascii" && word != "binary" && word != "binary_compressed")
      complain(fmt::format("'DATA {}' is none of ascii, binary and binary_compressed", word));
    header_.data = word == "ascii" ? PcdData::ascii : word == "binary" ? PcdData::binary : PcdData::binary_compressed;
    has_data_ = true;
  }

  std::vector<std::uint64_t> numbers(const std::vector<std::string_view>& values) const {
    std::vector<std::uint64_t> out;
    for (const std::string_view word : values) out.push_back(number({word}));
    return out;
  }
  std::uint64_t number(const std::vector<std::string_view>& values) const {
    std::uint64_t value = 0;
    if (values.empty() || !parse_number(values[0], value)) complain("a whole number is missing");
    return value;
  }

  void make_fields() {
    if (counts_.empty()) counts_.assign(names_.size(), 1);
    if (names_.empty() || sizes_.size() != names_.size() || types_.size() != names_.size() ||
        counts_.size() != names_.size())
      fail("{}: its PCD header names {} fields, but has {} sizes, {} types and {} counts; correct these lines.", name(),
           names_.size(), sizes_.size(), types_.size(), counts_.size());
    for (std::size_t f = 0; f < names_.size(); ++f) {
      const std::optional<Type> type = type_of(types_[f], sizes_[f]);
      if (!type)
        fail("{}: the PCD field '{}' has the type {} with {} bytes, which is unknown.", name(), names_[f], types_[f],
             sizes_[f]);
      if (counts_[f] > kMostBytes || header_.stride > kMostBytes)
        fail("{}: the PCD field '{}' makes a point larger than 1 MB; correct the line COUNT.", name(), names_[f]);
      const PcdField field{names_[f], *type, static_cast<std::uint32_t>(counts_[f]), header_.stride};
      header_.stride += field.bytes();
      header_.fields.push_back(field);
    }
    if (header_.stride == 0) fail("{}: the points of this PCD file have no bytes; correct the line COUNT.", name());
  }

  const InputFile& file_;
  LineReader lines_;
  PcdHeader header_;
  std::vector<std::string> names_, types_;
  std::vector<std::uint64_t> sizes_, counts_;
  std::optional<std::uint64_t> points_;
  bool has_data_ = false;
};

}  // namespace

Schema PcdHeader::schema() const {
  Schema schema;
  schema.stride = stride;
  for (const PcdField& field : fields) {
    if (field.name == "_" || field.count == 0) continue;
    if ((field.name == "rgb" || field.name == "rgba") && field.bytes() == 4) {
      // The bytes of the word, from the lowest on, are blue, green, red and alpha (unused in rgb).
      const auto part = [&](const char* name, std::uint32_t byte) {
        schema.fields.push_back({.name = name, .type = Type::u8, .offset = field.offset + byte});
      };
      part("red", 2), part("green", 1), part("blue", 0);
      if (field.name == "rgba") part("alpha", 3);
      continue;
    }
    schema.fields.push_back({.name = field.name, .type = field.type, .offset = field.offset, .count = field.count});
  }
  return schema;
}

PcdHeader read_pcd_header(const InputFile& file) { return HeaderParser(file).parse(); }

}  // namespace pointsweep
