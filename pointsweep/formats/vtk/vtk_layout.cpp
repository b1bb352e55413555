// SPDX-License-Identifier: MIT
#include "pointsweep/formats/vtk/vtk_layout.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/formats/files/number_text.h"
#include "pointsweep/storage/remote/url.h"

namespace pointsweep {
namespace {

constexpr std::size_t kMostArrays = 1024;
constexpr std::uint64_t kMostComponents = 65536;
constexpr std::size_t kVtkWindow = 16 << 10;
constexpr std::string_view kSignature = "# vtk DataFile Version";

bool is_blank_byte(std::byte b) { return is_space(static_cast<char>(b)); }

std::string upper_case(std::string_view text) {
  std::string upper(text);
  for (char& c : upper) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return upper;
}

/// Returns the type for a name that VTK 3 to 9 write; nothing for other names. A vtkIdType is written as an int.
std::optional<Type> vtk_type(const std::string& name) {
  static constexpr std::pair<std::string_view, Type> kTypes[] = {
      {"CHAR", Type::i8},          {"SIGNED_CHAR", Type::i8},     {"UNSIGNED_CHAR", Type::u8},
      {"SHORT", Type::i16},        {"UNSIGNED_SHORT", Type::u16}, {"INT", Type::i32},
      {"UNSIGNED_INT", Type::u32}, {"LONG", Type::i64},           {"UNSIGNED_LONG", Type::u64},
      {"VTKIDTYPE", Type::i32},    {"VTKTYPEINT64", Type::i64},   {"VTKTYPEUINT64", Type::u64},
      {"FLOAT", Type::f32},        {"DOUBLE", Type::f64}};
  const auto known = std::ranges::find(kTypes, name, &std::pair<std::string_view, Type>::first);
  return known == std::end(kTypes) ? std::nullopt : std::optional(known->second);
}

class VtkParser {
 public:
  explicit VtkParser(const InputFile& file) : file_(file), text_(file) {}

  VtkLayout parse() {
    text_.line(), text_.line();  // signature and title
    std::string_view third = text_.line().value_or("");
    const std::string encoding = upper_case(take_word(third));
    if (encoding != "ASCII" && encoding != "BINARY")
      fail("{}: line 3 of a VTK file should be ASCII or BINARY; the file is damaged.", name());
    layout_.text = encoding == "ASCII";
    while (const auto word = text_.word()) take(upper_case(*word));
    if (layout_.arrays.empty())
      fail("{}: this VTK file ({}) has no POINTS; export its points as PLY.", name(),
           layout_.dataset.empty() ? "without a DATASET" : layout_.dataset);
    return std::move(layout_);
  }

 private:
  enum class Section : std::uint8_t { geometry, points, cells };

  std::string name() const { return file_.path().string(); }
  [[noreturn]] void complain(std::string_view what) const {
    fail("{}: before byte {}: {}; correct the file or write it again.", name(), text_.offset(), what);
  }

  void take(const std::string& keyword) {
    std::string_view rest = keyword == "METADATA" ? std::string_view() : text_.line().value_or("");
    line_ = rest;  // a copy, since the scanner reuses its buffer
    rest = line_;
    if (keyword == "DATASET") return take_dataset(rest);
    if (keyword == "DIMENSIONS" || keyword == "ORIGIN" || keyword == "SPACING" || keyword == "ASPECT_RATIO") return;
    if (keyword == "POINTS") return take_points(rest);
    if (keyword == "CELL_TYPES") return skip("CELL_TYPES", "INT", number(rest), 1);
    if (keyword == "METADATA") return skip_metadata();
    if (keyword == "FIELD") return take_field(rest);
    if (keyword == "POINT_DATA" || keyword == "CELL_DATA") return take_section(keyword, rest);
    for (const char* cells : {"VERTICES", "LINES", "POLYGONS", "TRIANGLE_STRIPS", "CELLS"})
      if (keyword == cells) return take_cells(keyword, rest);
    take_attribute(keyword, rest);
  }

  std::uint64_t number(std::string_view& line) const {
    std::uint64_t value = 0;
    const std::string_view word = take_word(line);
    if (!parse_number(word, value)) complain(fmt::format("a whole number is missing, '{}' stands there", word));
    return value;
  }

  void take_dataset(std::string_view rest) {
    layout_.dataset = upper_case(take_word(rest));
    for (const char* known : {"POLYDATA", "UNSTRUCTURED_GRID", "STRUCTURED_GRID"})
      if (layout_.dataset == known) return;
    fail(
        "{}: is a VTK file of the kind {}; POLYDATA, UNSTRUCTURED_GRID and STRUCTURED_GRID hold points that "
        "pointsweep reads. Export its points as PLY.",
        name(), layout_.dataset);
  }

  void take_points(std::string_view rest) {
    if (!layout_.arrays.empty()) complain("POINTS stands there a second time");
    layout_.count = number(rest);
    add_array({.name = "position", .components = 3}, take_word(rest), layout_.count);
    if (layout_.arrays.empty()) complain("POINTS have a type that coordinates cannot have");
  }

  void take_section(const std::string& keyword, std::string_view rest) {
    section_ = keyword == "POINT_DATA" ? Section::points : Section::cells;
    rows_ = number(rest);
    if (section_ == Section::points && (layout_.arrays.empty() || rows_ != layout_.count))
      complain(fmt::format("POINT_DATA are for {} points, and there are {}", rows_, layout_.count));
  }

  /// Skips a section of cells. Until version 5.0, its line has the number of cells and the number of ints that follow.
  /// Since 5.1, the line has the lengths of the two arrays that follow, OFFSETS (one more than cells) and CONNECTIVITY.
  void take_cells(const std::string& keyword, std::string_view rest) {
    const std::uint64_t first = number(rest), second = number(rest);
    const std::uint64_t before = text_.offset();
    std::string_view line = line_ = text_.line().value_or("");
    const bool offsets = upper_case(take_word(line)) == "OFFSETS";
    if (offsets) {
      skip(keyword, upper_case(take_word(line)), first, 1);
      if (upper_case(text_.word().value_or("")) != "CONNECTIVITY") complain("CONNECTIVITY is missing after OFFSETS");
      line_ = text_.line().value_or("");
      line = line_;
      skip(keyword, upper_case(take_word(line)), second, 1);
    } else {
      text_.jump(before);
      skip(keyword, "INT", second, 1);
    }
    if (keyword != "VERTICES") layout_.cells += offsets && first > 0 ? first - 1 : first;
  }

  void skip_metadata() {
    text_.line();
    while (const auto line = text_.line())
      if (is_blank(*line)) return;
  }

  void take_field(std::string_view rest) {
    take_word(rest);
    for (std::uint64_t i = number(rest); i > 0; --i) {
      auto first = text_.word();
      if (first && upper_case(*first) == "METADATA") {
        skip_metadata();
        first = text_.word();
      }
      if (!first) complain("arrays of FIELD are missing");
      VtkArray array{.name = percent_decoded(*first)};
      line_ = text_.line().value_or("");
      std::string_view line = line_;
      array.components = components(number(line));
      const std::uint64_t rows = number(line);
      const std::string_view type = take_word(line);
      if (section_ == Section::points && rows == rows_) {
        add_array(std::move(array), type, rows);
      } else {
        if (section_ == Section::points) layout_.left_out.push_back(array.name);
        skip(array.name, upper_case(type), rows, array.components);
      }
    }
  }

  std::uint32_t components(std::uint64_t number) const {
    if (number > kMostComponents) complain(fmt::format("an array has {} components", number));
    return static_cast<std::uint32_t>(number);
  }

  void take_attribute(const std::string& keyword, std::string_view rest) {
    if (section_ == Section::geometry) complain(fmt::format("'{}' is no keyword of VTK", keyword.substr(0, 40)));
    VtkArray array{.name = percent_decoded(take_word(rest))};
    if (keyword == "LOOKUP_TABLE") return skip_lookup_table(number(rest));
    if (keyword == "COLOR_SCALARS") {
      array.name = "color";
      array.components = components(number(rest));
      array.shares = layout_.text;
      return add_array(std::move(array), "unsigned_char", rows_);
    }
    static constexpr std::pair<std::string_view, std::uint32_t> kComponents[] = {
        {"SCALARS", 1},  {"TEXTURE_COORDINATES", 2}, {"VECTORS", 3},      {"NORMALS", 3},   {"TENSORS", 9},
        {"TENSORS6", 6}, {"GLOBAL_IDS", 1},          {"PEDIGREE_IDS", 1}, {"EDGE_FLAGS", 1}};
    const auto known = std::ranges::find(kComponents, keyword, &std::pair<std::string_view, std::uint32_t>::first);
    if (known == std::end(kComponents)) complain(fmt::format("'{}' is no keyword of VTK", keyword.substr(0, 40)));
    array.components = known->second;
    if (keyword == "NORMALS") array.name = "normals";
    if (keyword == "TEXTURE_COORDINATES") array.components = components(number(rest));
    const std::string type(take_word(rest));
    if (keyword == "SCALARS") {
      if (!is_blank(rest)) array.components = components(number(rest));
      pass_lookup_table();
    }
    add_array(std::move(array), type, rows_);
  }

  /// Skips the line with the name of the table of SCALARS.
  void pass_lookup_table() {
    if (upper_case(text_.word().value_or("")) != "LOOKUP_TABLE") complain("LOOKUP_TABLE is missing after SCALARS");
    text_.line();
  }

  void skip_lookup_table(std::uint64_t colors) {
    if (colors > file_.size()) complain(fmt::format("a LOOKUP_TABLE of {} colours does not fit into the file", colors));
    skip("LOOKUP_TABLE", "UNSIGNED_CHAR", colors, 4);
  }

  /// Adds an array of points to the layout. Skips an array of cells, and an array without components or of a type that
  /// no attribute can have.
  void add_array(VtkArray array, std::string_view type_name, std::uint64_t rows) {
    const std::string type = upper_case(type_name);
    const std::optional<Type> known = vtk_type(type);
    if (section_ == Section::cells || !known || array.components == 0) {
      if (section_ == Section::points) layout_.left_out.push_back(array.name);
      return skip(array.name, type, rows, array.components);
    }
    array.type = layout_.text && type == "VTKIDTYPE" ? Type::i64 : *known;
    if (layout_.arrays.size() == kMostArrays) fail("{}: has more than {} arrays.", name(), kMostArrays);
    array.begin = text_.offset();
    if (layout_.text)
      find_places(array, rows);
    else
      skip(array.name, type, rows, array.components);
    layout_.arrays.push_back(std::move(array));
  }

  void find_places(VtkArray& array, std::uint64_t rows) {
    for (std::uint64_t row = 0; row < rows; row += VtkLayout::kRowsPerPlace) {
      const std::uint64_t n = std::min(VtkLayout::kRowsPerPlace, rows - row) * array.components;
      const std::uint64_t place = text_.offset();
      const std::uint64_t found = text_.skip_words(n);
      if (found < n) fail_truncated(array.name, rows, row + found / array.components);
      array.places.push_back(place);
    }
  }

  /// Skips the values of an array.
  void skip(const std::string& what, const std::string& type, std::uint64_t rows, std::uint32_t components) {
    if (components == 0 || rows == 0) return;
    const std::optional<Type> known = vtk_type(type);
    if (!known && type != "BIT")
      fail(
          "{}: '{}' has values of the type '{}', which pointsweep does not read; leave it out when you write the file.",
          name(), what, type);
    const std::uint64_t left = file_.size() - std::min(file_.size(), text_.offset());
    if (rows > 8 * (left + 1)) fail_truncated(what, rows, 0);  // this bound also keeps products from overflow
    const std::uint64_t values = rows * components;
    if (layout_.text) {
      const std::uint64_t found = text_.skip_words(values);
      if (found < values) fail_truncated(what, rows, found / components);
      return;
    }
    const std::uint64_t bytes = known ? values * size_of(*known) : (values + 7) / 8;
    if (bytes > left) fail_truncated(what, rows, known ? left / (size_of(*known) * components) : 0);
    text_.jump(text_.offset() + bytes);
  }

  [[noreturn]] void fail_truncated(const std::string& what, std::uint64_t rows, std::uint64_t found) const {
    fail("{}: '{}' should have {} rows, but the file ends after {}; get the whole file.", name(), what, rows, found);
  }

  const InputFile& file_;
  VtkScanner text_;
  VtkLayout layout_;
  Section section_ = Section::geometry;
  std::uint64_t rows_ = 0;  ///< number of rows that the arrays of the current section have
  std::string line_;
};

}  // namespace

bool starts_as_vtk(std::string_view head) { return head.starts_with(kSignature); }

VtkLayout read_vtk_layout(const InputFile& file) { return VtkParser(file).parse(); }

void VtkScanner::jump(std::uint64_t offset) {
  block_offset_ = offset;
  at_ = end_ = 0;
}

/// Moves the unread bytes to the front of the buffer and fills the rest. Returns false at the end of the file.
bool VtkScanner::read_more() {
  block_.resize(kVtkWindow);
  const std::size_t unread = end_ - at_;
  if (unread == kVtkWindow)
    fail("{}: byte {}: a word or line is longer than {} bytes; the file is damaged.", file_->path().string(), offset(),
         kVtkWindow);
  std::memmove(block_.data(), block_.data() + at_, unread);
  block_offset_ += at_;
  at_ = 0;
  end_ = unread;
  const std::size_t got = file_->read_some(block_offset_ + unread, std::span(block_).subspan(unread));
  end_ += got;
  return got != 0;
}

bool VtkScanner::skip_blanks() {
  for (;;) {
    while (at_ < end_ && is_blank_byte(block_[at_])) ++at_;
    if (at_ < end_) return true;
    if (!read_more()) return false;
  }
}

std::optional<std::string_view> VtkScanner::word() {
  if (!skip_blanks()) return std::nullopt;
  for (std::size_t length = 1;; ++length) {
    if (at_ + length == end_ && !read_more()) length = end_ - at_;
    if (at_ + length < end_ && !is_blank_byte(block_[at_ + length])) continue;
    const std::string_view word(reinterpret_cast<const char*>(block_.data() + at_), length);
    at_ += length;
    return word;
  }
}

std::optional<std::string_view> VtkScanner::line() {
  for (std::size_t searched = 0;;) {
    const void* found = nullptr;
    if (end_ - at_ > searched) found = std::memchr(block_.data() + at_ + searched, '\n', end_ - at_ - searched);
    searched = end_ - at_;
    if (found == nullptr && read_more()) continue;
    if (found == nullptr && at_ == end_) return std::nullopt;
    const std::byte* const begin = block_.data() + at_;
    const std::size_t length =
        found == nullptr ? end_ - at_ : static_cast<std::size_t>(static_cast<const std::byte*>(found) - begin);
    at_ += length + (found == nullptr ? 0 : 1);
    const std::string_view line(reinterpret_cast<const char*>(begin), length);
    return line.ends_with('\r') ? line.substr(0, length - 1) : line;
  }
}

std::uint64_t VtkScanner::skip_words(std::uint64_t words) {
  std::uint64_t passed = 0;
  while (passed < words && word()) ++passed;
  return passed;
}

}  // namespace pointsweep
