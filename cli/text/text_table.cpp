// SPDX-License-Identifier: MIT
#include "cli/text/text_table.h"

#include <fmt/format.h>

#include <algorithm>

namespace pointsweep {

std::string TextTable::text() const {
  std::vector<std::size_t> widths(lines_.front().size(), 0);
  for (const auto& line : lines_)
    for (std::size_t c = 0; c < line.size(); ++c) widths[c] = std::max(widths[c], line[c].size());
  std::string text;
  for (const auto& line : lines_) {
    std::string row = indent_;
    for (std::size_t c = 0; c < line.size(); ++c) {
      const bool is_left = std::ranges::find(left_, c) != left_.end();
      row += (c == 0 ? "" : "  ") +
             (is_left ? fmt::format("{:<{}}", line[c], widths[c]) : fmt::format("{:>{}}", line[c], widths[c]));
    }
    text += row.substr(0, row.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

}  // namespace pointsweep
