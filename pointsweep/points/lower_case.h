// SPDX-License-Identifier: MIT
/// Names in lower case, to be compared without regard to the case of ASCII letters, independent of the locale; and the
/// characters of texts in UTF-8.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace pointsweep {

inline std::string in_lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return lower;
}

/// Returns the first character of a text in UTF-8, which may take several bytes; "" for an empty text.
inline std::string_view first_character(std::string_view text) {
  std::size_t bytes = text.empty() ? 0 : 1;
  while (bytes < text.size() && (static_cast<unsigned char>(text[bytes]) & 0xc0) == 0x80) ++bytes;
  return text.substr(0, bytes);
}

}  // namespace pointsweep
