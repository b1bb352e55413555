// SPDX-License-Identifier: MIT
/// Well-known text of coordinate reference systems (OGC 01-009 and 18-010) as a tree of keywords.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pointsweep {

/// `KEYWORD["value", 12, CHILD[...]]`; round brackets mean the same.
struct WktNode {
  std::string keyword;              ///< in upper case
  std::vector<std::string> values;  ///< quoted texts and numbers in their order
  std::vector<WktNode> children;
};

/// Nothing for a text that is not WKT or nests deeper than 64 levels.
std::optional<WktNode> parse_wkt(std::string_view text);

/// The text without what follows a NUL, each run of white space outside quotes as one space, none at the ends.
std::string wkt_in_one_line(std::string_view text);

}  // namespace pointsweep
