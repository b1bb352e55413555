// SPDX-License-Identifier: MIT
/// Tables in columns as wide as their longest cells.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace pointsweep {

/// A table: headings and lines of cells.
class TextTable {
 public:
  /// `left`: the columns that are aligned to the left; all others are aligned to the right.
  TextTable(std::vector<std::string> headings, std::vector<std::size_t> left, std::string indent = "  ")
      : left_(std::move(left)), indent_(std::move(indent)), lines_{std::move(headings)} {}
  /// Adds a line with at most as many cells as there are headings.
  void add(std::vector<std::string> line) { lines_.push_back(std::move(line)); }
  /// Returns the headings, then the lines.
  std::string text() const;

 private:
  std::vector<std::size_t> left_;
  std::string indent_;
  std::vector<std::vector<std::string>> lines_;
};

}  // namespace pointsweep
