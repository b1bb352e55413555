// SPDX-License-Identifier: MIT
#include "cli/arguments.h"

#include <algorithm>

namespace pointsweep {

std::vector<std::string> arguments_for_parser(int argc, const char* const* argv) {
  std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    const bool apart = words[i] == "viewpoint" && i > 0 && words[i - 1] == "--orient";
    if (!apart && words[i] != "--orient=viewpoint") continue;
    words[i] += " " + words[i + 1];
    words.erase(words.begin() + static_cast<std::ptrdiff_t>(i) + 1);
  }
  std::reverse(words.begin(), words.end());
  return words;
}

}  // namespace pointsweep
