// SPDX-License-Identifier: MIT
#include "cli/text/file_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "cli/text/file_text.h"

namespace pointsweep {
namespace {

constexpr std::array kHeadings = {"file", "points", "x", "y", "z", "density", "crs", "attributes"};
using TableLine = std::array<std::string, kHeadings.size()>;

/// "EPSG:25832", with the code of the heights if there is one; the name of a system without a code.
std::string cell_of(const std::optional<Crs>& crs) {
  if (!crs) return "-";
  if (crs->epsg != 0)
    return fmt::format("EPSG:{}", crs->epsg) + (crs->vertical_epsg != 0 ? fmt::format("+{}", crs->vertical_epsg) : "");
  return crs->name.empty() ? "without a name" : crs->name;
}

/// Returns the extent along the axis, with as many decimals as tell ten thousand parts of it.
std::string cell_of_axis(const Box& bounds, int axis) {
  if (bounds.empty()) return "-";
  const double lo = bounds.lo[axis] + 0.0, hi = bounds.hi[axis] + 0.0;  // + 0: not "-0"
  if (!(hi > lo)) return fmt::format("{:.9g}", lo);
  const int decimals = static_cast<int>(std::clamp(4 - std::floor(std::log10(hi - lo)), 0.0, 9.0));
  return fmt::format("{:.{}f} .. {:.{}f}", lo, decimals, hi, decimals);
}

/// The number, from 1, of a list of attributes, which is new or known.
std::size_t number_of(std::vector<std::string>& lists, const std::string& list) {
  const auto at = std::ranges::find(lists, list);
  const auto number = static_cast<std::size_t>(at - lists.begin()) + 1;
  if (at == lists.end()) lists.push_back(list);
  return number;
}

TableLine line_of(const FileSummary& file, std::vector<std::string>& lists) {
  const std::optional<double> density = file.density();
  return {file.info.path.string(),      std::to_string(file.info.count),
          cell_of_axis(file.bounds, 0), cell_of_axis(file.bounds, 1),
          cell_of_axis(file.bounds, 2), density ? fmt::format("{:.4g}", *density) : "-",
          cell_of(file.info.crs),       fmt::format("({})", number_of(lists, attribute_text(file.info.schema)))};
}

/// Columns as wide as their longest cell, numbers to the right.
std::string text_of_lines(const std::vector<TableLine>& lines) {
  std::array<std::size_t, kHeadings.size()> widths{};
  for (const TableLine& line : lines)
    for (std::size_t c = 0; c < line.size(); ++c) widths[c] = std::max(widths[c], line[c].size());
  std::string text;
  for (const TableLine& line : lines) {
    std::string row;
    for (std::size_t c = 0; c < line.size(); ++c) {
      const bool is_number = c == 1 || c == 5;
      row += (c == 0 ? "" : "  ") +
             (is_number ? fmt::format("{:>{}}", line[c], widths[c]) : fmt::format("{:<{}}", line[c], widths[c]));
    }
    text += row.substr(0, row.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

}  // namespace

std::string table_of(const ListedSummaries& files) {
  std::vector<TableLine> lines(1);
  std::ranges::copy(kHeadings, lines.front().begin());
  std::vector<std::string> lists;
  for (const FileSummary& file : files.readable) lines.push_back(line_of(file, lists));
  for (const auto& [number, name] : files.unreadable)
    lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(1 + number), {name.string(), "cannot be read"});
  std::string text = text_of_lines(lines);
  for (std::size_t i = 0; i < lists.size(); ++i) text += fmt::format("attributes ({})  {}\n", i + 1, lists[i]);
  return text;
}

std::optional<double> density_of(std::span<const FileSummary> files) {
  double points = 0, area = 0;
  for (const FileSummary& file : files) {
    if (file.area > 0) points += static_cast<double>(file.info.count - file.nonfinite);
    area += file.area;
  }
  return area > 0 ? std::optional(points / area) : std::nullopt;
}

std::string summary_of(const ListedSummaries& files) {
  std::uint64_t points = 0;
  Box bounds;
  for (const FileSummary& file : files.readable) {
    points += file.info.count;
    bounds.include(file.bounds);
  }
  const std::size_t readable = files.readable.size();
  std::string text = readable == files.size() ? fmt::format("all {} files\n", readable)
                                              : fmt::format("{} of {} files\n", readable, files.size());
  text += to_text(points, bounds);
  if (const auto density = density_of(files.readable))
    text += fmt::format("  density     {:.4g} points per square unit of x and y\n", *density);
  const std::vector<std::string> sentences = inconsistencies_of(files.readable);
  if (readable > 1 && sentences.empty()) text += "  The files are consistent.\n";
  if (!sentences.empty()) text += "  inconsistent\n";
  for (const std::string& sentence : sentences) text += fmt::format("    {}\n", sentence);
  return text;
}

}  // namespace pointsweep
