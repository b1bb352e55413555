// SPDX-License-Identifier: MIT
/// Well-known text of coordinate reference systems (OGC 01-009 and 18-010) as a tree of keywords.
#include "pointsweep/formats/crs.h"
#include "pointsweep/formats/files/number_text.h"

namespace pointsweep {
namespace {

constexpr int kMostLevels = 64;

bool is_wkt_word(char c) {
  return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '.' ||
         c == '+' || c == '-';
}
bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }
bool opens(char c) { return c == '[' || c == '('; }
bool closes(char c) { return c == ']' || c == ')'; }
char upper_letter(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }

class WktParser {
 public:
  explicit WktParser(std::string_view text) : text_(text) {}

  std::optional<WktNode> run() {
    WktNode root;
    if (!parse_node(root, 0)) return std::nullopt;
    skip_space();
    if (!at_end() && text_[at_] == ',') {  // Esri writes a vertical system after the horizontal one
      ++at_;
      WktNode compound{"COMPD_CS", {}, {std::move(root), {}}};
      root = std::move(compound);
      if (!parse_node(root.children.back(), 1)) return std::nullopt;
      skip_space();
    }
    return at_ == text_.size() ? std::optional(std::move(root)) : std::nullopt;
  }

 private:
  bool at_end() const { return at_ == text_.size(); }
  void skip_space() {
    while (!at_end() && is_space(text_[at_])) ++at_;
  }

  std::string_view take_word() {
    const std::size_t start = at_;
    while (!at_end() && is_wkt_word(text_[at_])) ++at_;
    return text_.substr(start, at_ - start);
  }

  bool parse_node(WktNode& node, int level) {
    skip_space();
    if (level > kMostLevels || at_end() || !is_letter(text_[at_])) return false;
    for (const char c : take_word()) node.keyword += upper_letter(c);
    skip_space();
    if (at_end() || !opens(text_[at_])) return true;  // a bare word such as EAST
    do {
      ++at_;
      if (!parse_item(node, level)) return false;
      skip_space();
    } while (!at_end() && text_[at_] == ',');
    if (at_end() || !closes(text_[at_])) return false;
    ++at_;
    return true;
  }

  bool parse_item(WktNode& node, int level) {
    skip_space();
    if (at_end()) return false;
    if (text_[at_] == '"') return parse_quoted(node.values.emplace_back());
    if (is_letter(text_[at_])) return parse_node(node.children.emplace_back(), level + 1);
    node.values.emplace_back(take_word());
    return !node.values.back().empty();
  }

  /// Parses a quoted text, in which two successive quotes stand for one quote.
  bool parse_quoted(std::string& value) {
    for (++at_; !at_end(); ++at_) {
      if (text_[at_] == '"') {
        ++at_;
        if (at_end() || text_[at_] != '"') return true;
      }
      value += text_[at_];
    }
    return false;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

std::optional<WktNode> parse_wkt(std::string_view text) { return WktParser(text).run(); }

std::string wkt_in_one_line(std::string_view text) {
  text = text.substr(0, text.find('\0'));
  std::string line;
  bool quoted = false, space = false;
  for (const char c : text) {
    if (!quoted && is_space(c)) {
      space = !line.empty();
      continue;
    }
    if (space) line += ' ';
    space = false;
    if (c == '"') quoted = !quoted;
    line += is_space(c) ? ' ' : c;
  }
  return line;
}

}  // namespace pointsweep
