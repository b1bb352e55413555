// SPDX-License-Identifier: MIT
#include "pointsweep/formats/text/text_cells.h"

#include <algorithm>
#include <limits>

#include "pointsweep/formats/files/number_text.h"

namespace pointsweep {
namespace {

bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
bool is_quote(char c) { return c == '"' || c == '\''; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

/// Offset of the first character from `at` on for which `ends` holds, outside quotes.
template <class Predicate>
std::size_t find_unquoted(std::string_view line, std::size_t at, Predicate ends) {
  char quote = 0;
  for (; at < line.size(); ++at) {
    if (quote != 0) {
      if (line[at] == quote) quote = 0;
    } else if (ends(line[at])) {
      return at;
    } else if (is_quote(line[at])) {
      quote = line[at];
    }
  }
  return line.size();
}

std::string_view cell_of(std::string_view text) {
  text = trimmed(text);
  if (text.size() < 2 || !is_quote(text.front()) || text.back() != text.front()) return text;
  return trimmed(text.substr(1, text.size() - 2));
}

bool is_word(std::string_view word, std::string_view lower_case) {
  return std::equal(word.begin(), word.end(), lower_case.begin(), lower_case.end(),
                    [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; });
}

}  // namespace

Separator separator_of(std::string_view line) {
  const auto has = [&](char wanted) {
    return find_unquoted(line, 0, [=](char c) { return c == wanted; }) != line.size();
  };
  for (const Separator separator : {Separator::semicolon, Separator::bar, Separator::comma})
    if (has(static_cast<char>(separator))) return separator;
  return Separator::space;
}

void split_cells(std::string_view line, Separator separator, std::vector<std::string_view>& cells) {
  cells.clear();
  if (separator == Separator::space) {
    for (std::size_t at = 0;;) {
      while (at < line.size() && is_space(line[at])) ++at;
      if (at == line.size()) return;
      const std::size_t end = find_unquoted(line, at, is_space);
      cells.push_back(cell_of(line.substr(at, end - at)));
      at = end;
    }
  }
  for (std::size_t at = 0; at <= line.size();) {
    const std::size_t end = find_unquoted(line, at, [=](char c) { return c == static_cast<char>(separator); });
    const std::string_view cell = cell_of(line.substr(at, end - at));
    if (end == line.size() && cell.empty()) return;
    cells.push_back(cell);
    at = end + 1;
  }
}

bool is_text_row(std::string_view line) {
  std::size_t at = 0;
  while (at < line.size() && is_space(line[at])) ++at;
  if (at == line.size() || line[at] == '#' || line[at] == '%') return false;
  return !line.substr(at).starts_with("//");
}

bool is_pts_row(std::string_view line) {
  return is_text_row(line) && trimmed(line).find_first_of(" \t,;|") != line.npos;
}

std::string_view comment_of(std::string_view line) {
  line = trimmed(line);
  if (!line.starts_with('#') && !line.starts_with('%') && !line.starts_with("//")) return {};
  return trimmed(line.substr(std::min(line.find_first_not_of("#/%"), line.size())));
}

bool parse_cell(std::string_view cell, double& value) {
  if (parse_number(cell, value)) return true;
  if (!cell.empty() && !is_word(cell, "na") && !is_word(cell, "n/a") && !is_word(cell, "null")) return false;
  value = std::numeric_limits<double>::quiet_NaN();
  return true;
}

}  // namespace pointsweep
