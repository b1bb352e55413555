// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/formats/npy/npy_format.h"

namespace pointsweep {
namespace {

struct PyLiteral {
  enum class Kind : std::uint8_t { text, number, boolean, list, dictionary };
  Kind kind = Kind::list;
  std::string text;              ///< value of a text
  std::uint64_t number = 0;      ///< value of a number; 0 or 1 for a boolean
  std::vector<PyLiteral> items;  ///< elements of a tuple or list; alternating keys and values of a dictionary

  /// Returns the value of a key of a dictionary; null if there is none.
  const PyLiteral* find(std::string_view key) const;
};

constexpr int kMostLevels = 8;

class PyParser {
 public:
  explicit PyParser(std::string_view text) : text_(text) {}

  std::optional<PyLiteral> value(int level) {
    skip_blanks();
    if (text_.empty() || level > kMostLevels) return std::nullopt;
    switch (text_.front()) {
      case '(':
        return list(')', level);
      case '[':
        return list(']', level);
      case '{':
        return list('}', level);
      case '\'':
      case '"':
        return quoted();
      default:
        return word();
    }
  }
  bool at_end() {
    skip_blanks();
    return text_.empty();
  }

 private:
  void skip_blanks() { text_.remove_prefix(std::min(text_.find_first_not_of(" \t\r\n"), text_.size())); }
  bool take(char c) {
    skip_blanks();
    if (!text_.starts_with(c)) return false;
    text_.remove_prefix(1);
    return true;
  }

  std::optional<PyLiteral> list(char end, int level) {
    text_.remove_prefix(1);
    PyLiteral out;
    if (end == '}') out.kind = PyLiteral::Kind::dictionary;
    while (!take(end)) {
      auto item = value(level + 1);
      if (!item) return std::nullopt;
      out.items.push_back(std::move(*item));
      if (end == '}') {
        if (!take(':') || !(item = value(level + 1))) return std::nullopt;
        out.items.push_back(std::move(*item));
      }
      if (take(',')) continue;
      if (!take(end)) return std::nullopt;
      break;
    }
    return out;
  }

  std::optional<PyLiteral> quoted() {
    const char quote = text_.front();
    const std::size_t end = text_.find(quote, 1);
    if (end == text_.npos) return std::nullopt;
    PyLiteral out{.kind = PyLiteral::Kind::text, .text = std::string(text_.substr(1, end - 1)), .items = {}};
    text_.remove_prefix(end + 1);
    return out;
  }

  std::optional<PyLiteral> word() {
    for (const std::string_view boolean : {"False", "True"}) {
      if (!text_.starts_with(boolean)) continue;
      text_.remove_prefix(boolean.size());
      return PyLiteral{
          .kind = PyLiteral::Kind::boolean, .text = {}, .number = boolean == "True" ? 1u : 0u, .items = {}};
    }
    PyLiteral out{.kind = PyLiteral::Kind::number, .text = {}, .items = {}};
    const auto parsed = std::from_chars(text_.data(), text_.data() + text_.size(), out.number);
    // A number too large for 64 bits becomes the largest number, which no file reaches.
    if (parsed.ec == std::errc::result_out_of_range) out.number = std::numeric_limits<std::uint64_t>::max();
    if (parsed.ec == std::errc::invalid_argument) return std::nullopt;
    text_.remove_prefix(static_cast<std::size_t>(parsed.ptr - text_.data()));
    if (text_.starts_with('L')) text_.remove_prefix(1);  // Python 2 writes long integers with an L
    return out;
  }

  std::string_view text_;
};

const PyLiteral* PyLiteral::find(std::string_view key) const {
  for (std::size_t i = 0; kind == Kind::dictionary && i + 1 < items.size(); i += 2)
    if (items[i].kind == Kind::text && items[i].text == key) return &items[i + 1];
  return nullptr;
}

/// Parses a literal of Python: strings, whole numbers, True and False, and tuples, lists and dictionaries of up to 8
/// levels. Returns nothing for other text.
std::optional<PyLiteral> parse_py_literal(std::string_view text) {
  PyParser parser(text);
  auto value = parser.value(0);
  if (!parser.at_end()) return std::nullopt;
  return value;
}

constexpr std::uint64_t kMostHeaderBytes = 1 << 20;
constexpr std::uint32_t kMostItemBytes = 1 << 20;
using Kind = PyLiteral::Kind;

/// Reads and checks one header.
class NpyHeaderParser {
 public:
  NpyHeaderParser(const InputFile& file, std::uint64_t begin, std::uint64_t end, const std::string& what)
      : file_(file), begin_(begin), end_(end), what_(what) {}

  NpyHeader parse() {
    const std::string text = read_text();
    const auto dictionary = parse_py_literal(text);
    if (!dictionary || dictionary->kind != Kind::dictionary) fail("{}: its header is damaged.", what_);
    take_type(value_of(*dictionary, "descr"));
    header_.fortran_order = value_of(*dictionary, "fortran_order").number != 0;
    take_shape(value_of(*dictionary, "shape"));
    check_size();
    return std::move(header_);
  }

 private:
  std::string read_text() {
    std::string head(12, '\0');
    const std::uint64_t there = end_ - begin_;
    if (there < head.size()) fail("{}: is no NumPy array.", what_);
    file_.read_at(begin_, std::as_writable_bytes(std::span(head)));
    if (!head.starts_with("\x93NUMPY")) fail("{}: is no NumPy array.", what_);
    const auto byte = [&](std::size_t i) { return std::uint64_t{static_cast<unsigned char>(head[i])}; };
    const std::uint64_t prefix = byte(6) == 1 ? 10 : 12;
    const std::uint64_t length = byte(8) | byte(9) << 8 | (prefix == 12 ? byte(10) << 16 | byte(11) << 24 : 0);
    if (length > there - prefix || length > kMostHeaderBytes)
      fail("{}: its header is cut off or too long; it is damaged.", what_);
    std::string text(static_cast<std::size_t>(length), '\0');
    file_.read_at(begin_ + prefix, std::as_writable_bytes(std::span(text)));
    header_.data = begin_ + prefix + length;
    return text;
  }

  const PyLiteral& value_of(const PyLiteral& dictionary, std::string_view key) const {
    const PyLiteral* const value = dictionary.find(key);
    if (value == nullptr) fail("{}: its header has no '{}'; it is damaged.", what_, key);
    return *value;
  }

  void take_type(const PyLiteral& type) {
    header_.is_structured = type.kind == Kind::list;
    header_.description = header_.is_structured ? "a structured type" : type.text;
    if (!header_.is_structured) return append("", type.text, 1);
    for (const PyLiteral& field : type.items) {
      if (field.kind != Kind::list || field.items.size() < 2 || field.items.size() > 3)
        fail("{}: its header is damaged where it names fields.", what_);
      // A field with a title has a pair of texts, title and name, instead of its name.
      const PyLiteral& named = field.items[0];
      const std::string& name = named.items.size() == 2 ? named.items[1].text : named.text;
      if (field.items[1].kind != Kind::text)
        fail("{}: its field '{}' has fields itself, which pointsweep does not read.", what_, name);
      append(name, field.items[1].text, field.items.size() == 3 ? count_of(field.items[2], name) : 1);
    }
  }

  /// Returns the number of values in a field of this shape.
  std::uint32_t count_of(const PyLiteral& shape, const std::string& name) const {
    std::uint64_t count = shape.kind == Kind::number ? shape.number : 1;
    for (const PyLiteral& size : shape.items) {
      if (size.number > kMostItemBytes) count = std::uint64_t{kMostItemBytes} + 1;
      count = std::min<std::uint64_t>(count * size.number, std::uint64_t{kMostItemBytes} + 1);
    }
    if (count > kMostItemBytes) fail("{}: its field '{}' has more than {} values.", what_, name, kMostItemBytes);
    return static_cast<std::uint32_t>(count);
  }

  /// Appends a field of a type such as "<f4", ">u2" or "|V8": byte order, kind, bytes.
  void append(const std::string& name, const std::string& type, std::uint32_t count) {
    std::uint32_t bytes = 0;
    const bool complete =
        type.size() >= 3 && std::string_view("<>|=").find(type[0]) != std::string_view::npos &&
        std::from_chars(type.data() + 2, type.data() + type.size(), bytes).ptr == type.data() + type.size();
    const bool is_padding = complete && type[1] == 'V' && header_.is_structured;
    const std::optional<Type> known = complete && !is_padding ? plain_type(type[1], bytes) : std::nullopt;
    if (!known && !is_padding)
      fail("{}: holds '{}'{}, and pointsweep reads whole numbers and floats of 4 or 8 bytes; convert it with astype().",
           what_, type, name.empty() ? "" : fmt::format(" in the field '{}'", name));
    Schema& item = header_.item;
    const Type value = known.value_or(Type::u8);
    const std::uint64_t size = std::uint64_t{count} * (is_padding ? bytes : size_of(value));
    if (bytes > kMostItemBytes || size > kMostItemBytes || item.stride + size > kMostItemBytes)
      fail("{}: an element takes more than {} bytes.", what_, kMostItemBytes);
    if (!is_padding && count > 0) {
      item.fields.push_back({.name = name, .type = value, .offset = item.stride, .count = count});
      if (type[0] == '>') header_.big_endian.push_back(item.fields.back());
    }
    item.stride += static_cast<std::uint32_t>(size);
  }

  static std::optional<Type> plain_type(char kind, std::uint32_t bytes) {
    static constexpr Type kIntegers[] = {Type::i8,  Type::u8,  Type::i16, Type::u16,
                                         Type::i32, Type::u32, Type::i64, Type::u64};
    if (kind == 'f')
      return bytes == 4 ? std::optional(Type::f32) : bytes == 8 ? std::optional(Type::f64) : std::nullopt;
    if (kind == 'b' && bytes == 1) return Type::u8;  // NumPy stores True as 1
    if (kind != 'i' && kind != 'u') return std::nullopt;
    for (const Type type : kIntegers)
      if (size_of(type) == bytes && name_of(type).starts_with(kind == 'u' ? "uint" : "int")) return type;
    return std::nullopt;
  }

  void take_shape(const PyLiteral& shape) {
    if (shape.kind != Kind::list) fail("{}: its header has a damaged shape.", what_);
    for (const PyLiteral& size : shape.items) {
      if (size.kind != Kind::number) fail("{}: its header has a damaged shape.", what_);
      header_.shape.push_back(size.number);
    }
  }

  void check_size() const {
    const std::uint64_t there = end_ - header_.data, item = header_.item.stride;
    if (item == 0) fail("{}: its elements have no values.", what_);
    std::uint64_t elements = 1;
    for (const std::uint64_t size : header_.shape) {
      if (size == 0) elements = 0;
      if (elements != 0 && size > there / item / elements) fail_size(there);
      elements *= size;
    }
    if (elements * item != there) fail_size(there);
  }
  [[noreturn]] void fail_size(std::uint64_t there) const {
    fail("{}: its header speaks of the shape ({}) with elements of {} bytes, but {} bytes follow; it is damaged.",
         what_, fmt::join(header_.shape, ", "), header_.item.stride, there);
  }

  const InputFile& file_;
  std::uint64_t begin_, end_;
  const std::string& what_;
  NpyHeader header_;
};

}  // namespace

std::uint64_t NpyHeader::elements(std::size_t without) const {
  std::uint64_t product = 1;
  for (std::size_t i = 0; i + without < shape.size(); ++i) product *= shape[i];
  return product;
}

NpyHeader read_npy_header(const InputFile& file, std::uint64_t begin, std::uint64_t end, const std::string& what) {
  return NpyHeaderParser(file, begin, end, what).parse();
}

}  // namespace pointsweep
