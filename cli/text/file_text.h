// SPDX-License-Identifier: MIT
/// The texts of `pointsweep info`: a summary of a file as lines, a table of many files, and statistics of points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/info.h"

namespace pointsweep {

std::string to_text(const FileSummary& summary);
/// Returns a text like "x y z float32, intensity uint16".
std::string attribute_text(const Schema& schema);
/// Returns only the lines of the summary about points and bounds.
std::string to_text(std::uint64_t points, const Box& bounds);

/// Returns a table with the number of points of each group, if there is an attribute to group by; a table with a line
/// for each attribute of each group; and histograms with bars.
std::string to_text(const PointStatistics& statistics);

/// A table: headings and lines of cells, in columns as wide as their longest cells.
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

/// A table with a line for each file: points, bounds, density, coordinate reference system, and the number of its list
/// of attributes. The numbered lists follow the table.
class FileTable {
 public:
  void add(const FileSummary& file);
  void add_unreadable(const std::filesystem::path& file);
  std::string text() const;

 private:
  TextTable lines_{{"file", "points", "x", "y", "z", "density", "crs", "attributes"}, {0, 2, 3, 4, 6, 7}, ""};
  std::vector<std::string> lists_;
};

/// The sums over all files that `pointsweep info` reports on.
class FileTotals {
 public:
  void add(const FileSummary& file);
  void add_unreadable() { ++unreadable_; }

  std::size_t files() const { return readable_ + unreadable_; }
  std::size_t unreadable() const { return unreadable_; }
  std::uint64_t points() const { return points_; }
  const Box& bounds() const { return bounds_; }
  /// Returns the number of finite points of the files with an area per unit of their total area; none without an area.
  std::optional<double> density() const;
  /// Returns lines with the sums over all readable files, and the sentences on their inconsistencies.
  std::string text(const std::vector<std::string>& inconsistencies) const;

 private:
  std::size_t readable_ = 0, unreadable_ = 0;
  std::uint64_t points_ = 0;
  Box bounds_;
  double points_on_area_ = 0, area_ = 0;
  bool of_headers_ = false;
};

}  // namespace pointsweep
