// SPDX-License-Identifier: MIT
/// A summary of a file as lines, and a table of many files, for people.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/info.h"

namespace pointsweep {

std::string to_text(const FileSummary& summary);
/// "x y z float32, intensity uint16".
std::string attribute_text(const Schema& schema);
/// "2 Ground": a class of LAS.
std::string text_of_class(std::uint8_t code);
/// The lines on points and bounds alone.
std::string to_text(std::uint64_t points, const Box& bounds);

/// Files in the order in which they were named.
struct ListedSummaries {
  std::vector<FileSummary> readable;
  std::vector<std::pair<std::size_t, std::filesystem::path>> unreadable;  ///< number among all files, and name

  std::size_t size() const { return readable.size() + unreadable.size(); }
};

/// A line for each file with points, bounds, density and coordinate reference system, and below them the lists of
/// attributes that the last column counts.
std::string table_of(const ListedSummaries& files);

/// Returns the sums over all readable files, and a sentence for each respect in which they differ (inconsistencies_of).
std::string summary_of(const ListedSummaries& files);

/// Finite points of all files for each unit of their areas together; none without area.
std::optional<double> density_of(std::span<const FileSummary> files);

}  // namespace pointsweep
