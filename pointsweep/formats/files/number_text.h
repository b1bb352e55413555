// SPDX-License-Identifier: MIT
/// The words of a line, and numbers as people and programs write them, independent of any locale.
#pragma once

#include <algorithm>
#include <string_view>
#include <vector>

namespace pointsweep {

/// Returns whether a character separates words: a space, tab, line feed, vertical tab, form feed or carriage return.
constexpr bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

/// Removes the first word from `line` and returns it; empty if there is none.
inline std::string_view take_word(std::string_view& line) {
  std::size_t begin = 0;
  while (begin < line.size() && is_space(line[begin])) ++begin;
  std::size_t end = begin;
  while (end < line.size() && !is_space(line[end])) ++end;
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

/// Returns the words of a line in their order.
inline std::vector<std::string_view> words_in(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) words.push_back(word);
  return words;
}

inline bool is_blank(std::string_view line) { return std::ranges::all_of(line, is_space); }

/// Reads all of `word` as a T (any type of a Field). Returns false if the word is not a number or does not fit. A
/// leading '+', "nan" and "inf" in any case and the spellings of Windows ("-1.#IND") are read; a number beyond the
/// range of a floating type becomes infinite or zero. Integers may be written as "12.0" or "1e3".
template <class T>
bool parse_number(std::string_view word, T& value);

}  // namespace pointsweep
