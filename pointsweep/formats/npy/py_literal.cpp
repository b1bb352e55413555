// SPDX-License-Identifier: MIT
#include "pointsweep/formats/npy/py_literal.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <utility>

namespace pointsweep {
namespace {

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
    // A number that is too large for any file becomes the largest.
    if (parsed.ec == std::errc::result_out_of_range) out.number = std::numeric_limits<std::uint64_t>::max();
    if (parsed.ec == std::errc::invalid_argument) return std::nullopt;
    text_.remove_prefix(static_cast<std::size_t>(parsed.ptr - text_.data()));
    if (text_.starts_with('L')) text_.remove_prefix(1);  // Python 2
    return out;
  }

  std::string_view text_;
};

}  // namespace

const PyLiteral* PyLiteral::find(std::string_view key) const {
  for (std::size_t i = 0; kind == Kind::dictionary && i + 1 < items.size(); i += 2)
    if (items[i].kind == Kind::text && items[i].text == key) return &items[i + 1];
  return nullptr;
}

std::optional<PyLiteral> parse_py_literal(std::string_view text) {
  PyParser parser(text);
  auto value = parser.value(0);
  if (!parser.at_end()) return std::nullopt;
  return value;
}

}  // namespace pointsweep
