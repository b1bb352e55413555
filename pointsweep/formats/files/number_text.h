// SPDX-License-Identifier: MIT
/// The words of a line, and numbers as people and programs write them, independent of any locale.
#pragma once

#include <algorithm>
#include <string_view>

namespace pointsweep {

/// Removes the first word, up to a blank or tab, from `line` and returns it; empty if there is none.
inline std::string_view take_word(std::string_view& line) {
  const std::size_t begin = std::min(line.find_first_not_of(" \t\r"), line.size());
  const std::size_t end = std::min(line.find_first_of(" \t\r", begin), line.size());
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

inline bool is_blank(std::string_view line) { return line.find_first_not_of(" \t\r") == line.npos; }

/// Reads all of `word` as a T (any type of a Field). Returns false if the word is not a number or does not fit. A
/// leading '+', "nan" and "inf" in any case and the spellings of Windows ("-1.#IND") are read; a number beyond the
/// range of a floating type becomes infinite or zero. Integers may be written as "12.0" or "1e3".
template <class T>
bool parse_number(std::string_view word, T& value);

}  // namespace pointsweep
