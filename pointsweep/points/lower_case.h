// SPDX-License-Identifier: MIT
/// Names in lower case, to be compared without regard to the case of ASCII letters, independent of the locale.
#pragma once

#include <string>
#include <string_view>

namespace pointsweep {

inline std::string in_lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return lower;
}

}  // namespace pointsweep
