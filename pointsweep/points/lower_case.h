// SPDX-License-Identifier: MIT
/// Conversion of names to lower case, for comparisons that ignore the case of ASCII letters in every locale; and the
/// first character of a UTF-8 text.
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

/// Returns the bytes of the first character of a UTF-8 text; "" for an empty text.
inline std::string_view first_character(std::string_view text) {
  std::size_t bytes = text.empty() ? 0 : 1;
  while (bytes < text.size() && (static_cast<unsigned char>(text[bytes]) & 0xc0) == 0x80) ++bytes;
  return text.substr(0, bytes);
}

}  // namespace pointsweep
