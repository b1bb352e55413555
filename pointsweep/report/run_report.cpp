// SPDX-License-Identifier: MIT
#include "pointsweep/report/run_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pointsweep/render/png.h"
#include "pointsweep/report/page.h"
#include "pointsweep/report/plot.h"
#include "pointsweep/report/scale.h"

namespace pointsweep {
namespace {

std::string seconds_text(double seconds) { return fmt::format("{:.3g} s", seconds); }
std::string bytes_text(std::uint64_t bytes) { return short_number(static_cast<double>(bytes)) + "B"; }

/// At most `rows` points, each the largest of its stretch, so that no peak is lost.
std::vector<std::pair<double, double>> thinned(const std::vector<std::pair<std::uint64_t, std::uint64_t>>& series,
                                               std::size_t rows) {
  std::vector<std::pair<double, double>> thin;
  const std::size_t stretch = std::max<std::size_t>(1, (series.size() + rows - 1) / rows);
  for (std::size_t i = 0; i < series.size(); i += stretch) {
    const auto begin = series.begin() + static_cast<std::ptrdiff_t>(i);
    const auto end = begin + static_cast<std::ptrdiff_t>(std::min(stretch, series.size() - i));
    const auto most = std::max_element(begin, end, [](const auto& a, const auto& b) { return a.second < b.second; });
    thin.emplace_back(static_cast<double>(most->first), static_cast<double>(most->second));
  }
  return thin;
}

std::string working_set(const Statistics& s) {
  const double share = 100 / static_cast<double>(std::max<std::uint64_t>(s.points, 1));
  const auto in_percent = [share](const std::string& name, const auto& counts) {
    Series series{name, {}};
    for (const auto& [read, count] : thinned(counts, 600)) series.points.emplace_back(read, count * share);
    return series;
  };
  std::vector<Series> all = {in_percent("window", s.series)};
  for (const auto& [name, counts] : s.buffers) all.push_back(in_percent(name, counts));
  return line_plot({"Working set over the stream", "points read", "% of the cloud"}, all);
}

std::string times(const Statistics& s) {
  std::vector<Bar> bars = {{"ordering (wall)", s.order_seconds, {}},
                           {"reading and cutting", s.read_seconds, {}},
                           {"neighbours", s.search_seconds, {}}};
  for (const auto& [name, seconds] : s.operator_seconds) bars.push_back({name, seconds, {}});
  bars.push_back({"writing (wall)", s.write_seconds, {}});
  for (Bar& bar : bars) bar.label = seconds_text(bar.value);
  return bar_plot(fmt::format("Time, summed over {} threads", s.threads), bars);
}

std::string distances(const Statistics& s) {
  std::vector<double> edges;
  Histogram nearest{"to the nearest neighbour", {}}, farthest{"to the farthest of the neighbourhood", {}};
  for (const DistanceBin& bin : s.neighbor_distances) {
    if (bin.from <= 0) continue;
    edges.push_back(bin.from);
    const double octaves = std::log2(bin.to / bin.from);  // bins differ in width
    nearest.counts.push_back(static_cast<double>(bin.nearest) / octaves);
    farthest.counts.push_back(static_cast<double>(bin.farthest) / octaves);
  }
  if (edges.empty()) return {};
  edges.push_back(s.neighbor_distances.back().to);
  return histogram_plot({"Distances of neighbours", "distance, length unit of the cloud", "points per octave"}, edges,
                        {nearest, farthest});
}

std::uint64_t equal_points(const Statistics& s) {
  const bool any = !s.neighbor_distances.empty() && s.neighbor_distances.front().from <= 0;
  return any ? s.neighbor_distances.front().nearest : 0;
}

std::vector<std::pair<std::string, std::string>> rows_of(const RunSummary& summary) {
  const Statistics& s = summary.statistics;
  const auto number = [](std::uint64_t value) { return fmt::format("{}", value); };
  std::vector<std::pair<std::string, std::string>> rows = {
      {"command", summary.command},
      {"version", summary.version},
      {"input", summary.inputs},
      {"output", summary.output},
      {"points", number(s.points)},
      {"k", s.k == 0 ? "no limit" : number(s.k)},
      {"certified neighbourhoods", number(s.certified)},
      {"of these recalled", number(s.recalled)},
      {"degenerate results", number(s.degenerate)},
      {"points that are not finite", number(s.nonfinite)},
      {"time", seconds_text(s.total_seconds)},
      {"points per second", short_number(static_cast<double>(s.points) / std::max(s.total_seconds, 1e-9))},
      {"window, peak", fmt::format("{} points", s.peak_points)},
      {"window, mean", fmt::format("{:.0f} points", s.mean_points)},
      {"lifespan of a point, mean and longest",
       seconds_text(s.lifespan_mean_seconds) + ", " + seconds_text(s.lifespan_max_seconds)},
      {"memory, peak", bytes_text(s.peak_rss_bytes)},
      {"memory, budget", bytes_text(s.memory_budget_bytes)},
      {"read, spilled, written",
       bytes_text(s.bytes_read) + ", " + bytes_text(s.bytes_spilled) + ", " + bytes_text(s.bytes_written)},
      {"threads", number(s.threads)},
      {"machine", s.machine},
  };
  if (!s.neighbor_distances.empty()) rows.insert(rows.begin() + 10, {"duplicate points", number(equal_points(s))});
  return rows;
}

}  // namespace

std::string report_of(const RunSummary& summary) {
  Page page(summary.title);
  if (summary.picture) {
    const Rendering& r = *summary.picture;
    std::string caption = "The result, coloured by " + r.color;
    if (r.is_number) caption += fmt::format(": violet {:.4g} to yellow {:.4g}", r.lo, r.hi);
    page.picture(to_png(r.picture), caption);
  }
  const Statistics& s = summary.statistics;
  for (const std::string& warning : s.warnings) page.paragraph("Warning: " + warning);
  page.plot(working_set(s));
  page.plot(times(s));
  page.plot(distances(s));
  page.heading("Statistics");
  page.table(rows_of(summary));
  return page.html();
}

}  // namespace pointsweep
