// SPDX-License-Identifier: MIT
#include <algorithm>

#include "pointsweep/fail.h"
#include "pointsweep/formats/files/line_reader.h"
#include "pointsweep/formats/files/number_text.h"
#include "pointsweep/formats/ply/ply_format.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kLongestHeader = 1 << 20;

/// The names of types in PLY. The first name of a type is the one that outputs have.
struct TypeName {
  std::string_view name;
  Type type;
};
constexpr TypeName kTypeNames[] = {
    {"char", Type::i8},    {"uchar", Type::u8},    {"short", Type::i16},   {"ushort", Type::u16}, {"int", Type::i32},
    {"uint", Type::u32},   {"float", Type::f32},   {"double", Type::f64},  {"int8", Type::i8},    {"uint8", Type::u8},
    {"int16", Type::i16},  {"uint16", Type::u16},  {"int32", Type::i32},   {"uint32", Type::u32}, {"int64", Type::i64},
    {"uint64", Type::u64}, {"float32", Type::f32}, {"float64", Type::f64},
};

/// Builds a PlyHeader line by line.
class Parser {
 public:
  explicit Parser(const InputFile& file) : file_(file), lines_(file) {}

  PlyHeader run() {
    const auto magic = words_in(next_line());
    if (magic.size() != 1 || magic[0] != "ply") complain("a PLY file starts with a line 'ply'");
    while (parse_line(next_line())) {
    }
    if (!has_format_) complain("the header ends without a 'format' line");
    header_.body_offset = lines_.offset();
    header_.body_line = lines_.next_line();
    return std::move(header_);
  }

 private:
  [[noreturn]] void complain(std::string_view what) const {
    fail("{}: line {}: {}; the header of this PLY file is damaged.", file_.path().string(), lines_.line(), what);
  }

  std::string_view next_line() {
    const auto line = lines_.next();
    if (!line || lines_.offset() > kLongestHeader) {
      fail("{}: the PLY header has no 'end_header' line in its first {} bytes; the file is damaged or truncated.",
           file_.path().string(), lines_.offset());
    }
    return *line;
  }

  /// Parses a line. Returns false at the end of the header.
  bool parse_line(std::string_view line) {
    const auto words = words_in(line);
    if (words.empty()) return true;
    if (words[0] == "end_header") return false;
    if (words[0] == "comment" || words[0] == "obj_info") {
      header_.remarks.emplace_back(line.substr(static_cast<std::size_t>(words[0].data() - line.data())));
    } else if (words[0] == "format") {
      parse_format(words);
    } else if (words[0] == "element") {
      parse_element(words);
    } else if (words[0] == "property") {
      parse_property(words);
    } else {
      complain(fmt::format("'{}' is no word of a PLY header", words[0].substr(0, 40)));
    }
    return true;
  }

  void parse_format(const std::vector<std::string_view>& words) {
    if (words.size() != 3) complain("a format line is 'format ENCODING 1.0'");
    if (words[2] != "1.0") complain(fmt::format("version {} is not known, only 1.0", words[2].substr(0, 40)));
    has_format_ = true;
    for (const auto encoding : {PlyEncoding::ascii, PlyEncoding::little_endian, PlyEncoding::big_endian}) {
      if (words[1] != name_of(encoding)) continue;
      header_.encoding = encoding;
      return;
    }
    complain(fmt::format("encoding '{}' is none of ascii, binary_little_endian and binary_big_endian",
                         words[1].substr(0, 40)));
  }

  void parse_element(const std::vector<std::string_view>& words) {
    PlyElement element;
    if (words.size() != 3 || !parse_number(words[2], element.count)) {
      complain("an element line is 'element NAME COUNT'");
    }
    element.name = words[1];
    for (const PlyElement& other : header_.elements) {
      if (other.name == element.name) complain(fmt::format("element '{}' is declared twice", element.name));
    }
    header_.elements.push_back(std::move(element));
  }

  void parse_property(const std::vector<std::string_view>& words) {
    if (header_.elements.empty()) complain("a property comes before any element");
    PlyProperty property;
    if (words.size() == 3) {
      property.type = type_named(words[1]);
    } else if (words.size() == 5 && words[1] == "list") {
      property.is_list = true;
      property.count_type = type_named(words[2]);
      property.type = type_named(words[3]);
      if (property.count_type == Type::f32 || property.count_type == Type::f64) {
        complain("the count of a list is an integer");
      }
    } else {
      complain("a property line is 'property TYPE NAME' or 'property list TYPE TYPE NAME'");
    }
    property.name = words.back();
    header_.elements.back().properties.push_back(std::move(property));
  }

  Type type_named(std::string_view name) const {
    for (const TypeName& known : kTypeNames) {
      if (known.name == name) return known.type;
    }
    complain(fmt::format("'{}' is no type of PLY", name.substr(0, 40)));
  }

  const InputFile& file_;
  LineReader lines_;
  PlyHeader header_;
  bool has_format_ = false;
};

}  // namespace

bool PlyElement::has_list() const {
  return std::ranges::any_of(properties, [](const PlyProperty& p) { return p.is_list; });
}

std::uint32_t PlyElement::stride() const {
  std::size_t bytes = 0;
  for (const PlyProperty& property : properties) bytes += size_of(property.type);
  return static_cast<std::uint32_t>(bytes);
}

std::string_view ply_name_of(Type type) { return std::ranges::find(kTypeNames, type, &TypeName::type)->name; }

PlyHeader read_ply_header(const InputFile& file) { return Parser(file).run(); }

std::string_view name_of(PlyEncoding encoding) {
  static constexpr std::string_view kNames[] = {"ascii", "binary_little_endian", "binary_big_endian"};
  return kNames[static_cast<std::size_t>(encoding)];
}

}  // namespace pointsweep
