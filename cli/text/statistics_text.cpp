// SPDX-License-Identifier: MIT
/// Statistics of points as tables, for people.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <variant>
#include <vector>

#include "cli/text/file_text.h"

namespace pointsweep {
namespace {

constexpr std::size_t kHistogramBar = 40;

/// Returns the value with 7 significant digits if the attribute is float32, else with 10.
std::string number_text(double value, Type type) {
  return fmt::format("{:.{}g}", value + 0.0, type == Type::f32 ? 7 : 10);  // adding 0 turns -0 into 0
}

std::string number_text(const AttributeValue& value, Type type) {
  if (const double* const real = std::get_if<double>(&value)) return number_text(*real, type);
  return std::visit([](auto v) { return fmt::format("{}", v); }, value);
}

std::string number_text(const std::optional<AttributeValue>& value, Type type) {
  return value ? number_text(*value, type) : "-";
}

/// Returns the name of a group: "2 Ground" for a class, "2" for values of other attributes.
std::string name_of_group(const PointGroup& group, const std::string& by) {
  const auto* const code = std::get_if<std::int64_t>(&*group.value);
  if (by == "classification" && code != nullptr && *code >= 0 && *code < 256)
    return text_of_class(static_cast<std::uint8_t>(*code));
  return std::visit([](auto v) { return fmt::format("{}", v); }, *group.value);
}

std::string counts_text(const PointStatistics& statistics) {
  TextTable table({statistics.by, "points", "share"}, {0});
  for (const PointGroup& group : statistics.groups)
    table.add(
        {name_of_group(group, statistics.by), fmt::format("{}", group.points),
         fmt::format("{:.2f} %", 100 * static_cast<double>(group.points) / static_cast<double>(statistics.points))});
  return table.text();
}

std::vector<std::string> line_of(const AttributeStatistics& a) {
  std::vector<std::string> line = {a.name, fmt::format("{}", a.count), number_text(a.min, a.type)};
  for (std::size_t q = 0; q < PointStatistics::kPercent.size(); ++q)
    line.push_back(a.quantiles.empty() ? "-" : number_text(a.quantiles[q], a.type));
  line.push_back(number_text(a.max, a.type));
  line.push_back(a.mean ? number_text(*a.mean, a.type) : "-");
  line.push_back(a.deviation ? fmt::format("{:.6g}", *a.deviation) : "-");
  return line;
}

std::string attributes_text(const PointStatistics& statistics) {
  const bool is_grouped = !statistics.by.empty();
  std::vector<std::string> headings = {"attribute", "count", "min"};
  for (const unsigned percent : PointStatistics::kPercent) headings.push_back(fmt::format("{} %", percent));
  headings.insert(headings.end(), {"max", "mean", "deviation"});
  if (is_grouped) headings.insert(headings.begin(), statistics.by);
  TextTable table(headings, is_grouped ? std::vector<std::size_t>{0, 1} : std::vector<std::size_t>{0});
  for (const PointGroup& group : statistics.groups) {
    for (const AttributeStatistics& a : group.attributes) {
      std::vector<std::string> line = line_of(a);
      if (is_grouped) line.insert(line.begin(), name_of_group(group, statistics.by));
      table.add(std::move(line));
    }
  }
  return table.text();
}

std::string histogram_text(const AttributeHistogram& histogram) {
  if (histogram.counts.empty()) return "  no finite value\n";
  const std::uint64_t most = std::ranges::max(histogram.counts);
  TextTable table({"from", "to", "count", ""}, {3});
  for (std::size_t bin = 0; bin < histogram.counts.size(); ++bin) {
    const std::uint64_t count = histogram.counts[bin];
    const double length = most == 0 ? 0 : kHistogramBar * (static_cast<double>(count) / static_cast<double>(most));
    table.add({number_text(histogram.edges[bin], Type::f64), number_text(histogram.edges[bin + 1], Type::f64),
               fmt::format("{}", count), std::string(static_cast<std::size_t>(std::ceil(length)), '#')});
  }
  return table.text();
}

}  // namespace

std::string to_text(const PointStatistics& statistics) {
  const bool is_grouped = !statistics.by.empty();
  std::string text;
  if (is_grouped) text += fmt::format("points by {}\n", statistics.by) + counts_text(statistics);
  const auto has_values = [](const PointGroup& group) { return !group.attributes.empty(); };
  if (std::ranges::any_of(statistics.groups, has_values))
    text += fmt::format("statistics of {} points\n", statistics.points) + attributes_text(statistics);
  for (const PointGroup& group : statistics.groups) {
    const std::string of = is_grouped ? fmt::format(", {} {}", statistics.by, name_of_group(group, statistics.by)) : "";
    for (const AttributeHistogram& histogram : group.histograms)
      text += fmt::format("histogram of {}{}\n", histogram.name, of) + histogram_text(histogram);
  }
  return text;
}

}  // namespace pointsweep
