// SPDX-License-Identifier: MIT
/// Names are compared without regard to upper and lower case, of ASCII letters alone and whatever the locale.
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
