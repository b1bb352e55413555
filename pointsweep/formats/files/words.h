// SPDX-License-Identifier: MIT
/// Words of a line, between blanks and tabs.
#pragma once

#include <algorithm>
#include <string_view>

namespace pointsweep {

/// Removes the first word from `line` and returns it; empty if there is none.
inline std::string_view take_word(std::string_view& line) {
  const std::size_t begin = std::min(line.find_first_not_of(" \t\r"), line.size());
  const std::size_t end = std::min(line.find_first_of(" \t\r", begin), line.size());
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

inline bool is_blank(std::string_view line) { return line.find_first_not_of(" \t\r") == line.npos; }

}  // namespace pointsweep
