// SPDX-License-Identifier: MIT
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ranges>
#include <set>
#include <string_view>

#include "pointsweep/math/quantile_rank.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/program/pipeline.h"
#include "pointsweep/program/report.h"
#include "pointsweep/render/legend.h"
#include "pointsweep/report/page.h"

namespace pointsweep {
namespace {

constexpr std::array<const char*, 6> kCurvatures = {
    "rms_curvature", "mean_curvature", "absolute_curvature", "k1", "surface_variation", "gaussian_curvature"};
/// Stages whose results no colour can show: lists, moved positions, or a new search or order.
constexpr std::array<std::string_view, 4> kNotPictured = {"neighbors", "fair", "reneighbor", "resort"};
/// Beginnings of the names of fields that are parts of vectors or of lists.
constexpr std::array<std::string_view, 6> kParts = {"splat_",     "k1_",       "normal_eigenvalue",
                                                    "neighbor_0", "distance_", "normal"};

bool is_part(std::string_view name) {
  return name == "nx" || name == "ny" || name == "nz" ||
         std::ranges::any_of(kParts, [&](std::string_view part) { return name.starts_with(part); });
}

/// Returns the colouring that shows the results of the operator `op`; empty if it has none to show. For all but a few
/// operators this is the first field with one component in `made`, the fields of the output that any operator has made.
std::string shown_by(std::string_view op, const std::vector<std::string>& made, const Schema& output) {
  if (op == "normals" || op == "splats") return output.find("nx") ? "plain" : "";
  if (op == "curvature") {
    for (const char* name : kCurvatures)
      if (output.find(name)) return name;
    return {};
  }
  if (std::ranges::find(kNotPictured, op) != kNotPictured.end()) return {};
  for (const std::string& name : made)
    if (output.fields[*output.find(name)].count == 1 && !is_part(name)) return name;
  return {};
}

}  // namespace

std::vector<std::string> made_numbers(std::span<const std::string> operators, const Schema& input,
                                      const Schema& output) {
  std::set<std::string> again;
  for (const std::string& op : operators)
    if (const OperatorDeclaration* declaration = declaration_of(op))
      for (const Attribute& a : contract_of(*declaration).makes) again.insert(a.fields.begin(), a.fields.end());
  std::vector<std::string> made;
  for (const Field& field : output.fields)
    if (!input.find(field.name) || again.contains(library_name_of(field.name))) made.push_back(field.name);
  return made;
}

std::string pictured_attribute(std::span<const std::string> operators, const Schema& input, const Schema& output) {
  const std::vector<std::string> made = made_numbers(operators, input, output);
  for (const std::string& op : operators | std::views::reverse) {
    const std::string shown = shown_by(op, made, output);
    if (!shown.empty()) return shown;
  }
  return {};
}

namespace {

constexpr std::size_t kBins = 48;
constexpr std::uint32_t kPercents[] = {0, 5, 25, 50, 75, 95, 100};
constexpr double kLargestWhole = 1e15;  ///< limit below which every whole number is exact as a double
/// About one value in this many lies below the range that the bins of a histogram divide, and about one above it. The
/// first and the last bin count these values.
constexpr std::uint32_t kOneBeyond = 200;

double quantile(const std::vector<double>& sorted, std::uint32_t part, std::uint32_t whole = 100) {
  return sorted[static_cast<std::size_t>(quantile_rank(sorted.size(), part, whole))];
}

void fill_bins(const std::vector<double>& sorted, bool whole, ValueSummary& summary) {
  double lo = quantile(sorted, 1, kOneBeyond), hi = quantile(sorted, kOneBeyond - 1, kOneBeyond);
  std::size_t bins = kBins;
  if (whole && hi - lo < kBins && std::max(-lo, hi) < kLargestWhole) {
    lo -= 0.5, hi += 0.5;
    bins = static_cast<std::size_t>(hi - lo);
  } else if (!(hi > lo)) {
    const double half = lo == 0 ? 0.5 : 0.5 * std::abs(lo);
    lo -= half, hi += half;
  }
  const double width = (hi - lo) / static_cast<double>(bins);
  for (std::size_t i = 0; i <= bins; ++i) summary.edges.push_back(lo + width * static_cast<double>(i));
  summary.counts.assign(bins, 0);
  for (const double v : sorted) {
    const double bin = std::clamp(std::floor((v - lo) / width), 0.0, static_cast<double>(bins - 1));
    ++summary.counts[static_cast<std::size_t>(bin)];
  }
}

ValueSummary summary_of(const Field& field, std::size_t stride, std::span<const std::byte> records) {
  ValueSummary summary{.name = field.name};
  std::vector<double> sorted;
  for (std::size_t at = 0; at + stride <= records.size(); at += stride) {
    const double v = value_of(field, records.data() + at);
    ++summary.values;
    std::isfinite(v) ? sorted.push_back(v) : void(++summary.undefined);
  }
  if (sorted.empty()) return summary;
  std::ranges::sort(sorted);
  std::ranges::transform(kPercents, summary.quantiles.begin(), [&](std::uint32_t p) { return quantile(sorted, p); });
  const bool whole = std::ranges::all_of(sorted, [](double v) { return v == std::floor(v); });
  fill_bins(sorted, whole, summary);
  return summary;
}

std::string seconds_text(double seconds) { return fmt::format("{:.3g} s", seconds); }
std::string bytes_text(std::uint64_t bytes) { return short_number(static_cast<double>(bytes)) + "B"; }

/// Returns at most `rows` points of the series: the one with the largest count in each of at most `rows` stretches, so
/// that no peak is lost.
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
  if (s.series.empty()) return {};
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

std::string times(const RunSummary& summary) {
  const Statistics& s = summary.statistics;
  std::vector<Bar> bars = {{"ordering (wall)", s.order_seconds, {}},
                           {"reading and cutting", s.read_seconds, {}},
                           {"neighbours", s.search_seconds, {}}};
  for (const auto& [name, seconds] : s.operator_seconds) bars.push_back({name, seconds, {}});
  bars.push_back({"writing (wall)", s.write_seconds, {}});
  if (summary.picture) bars.push_back({"drawing this page (wall)", summary.drawing_seconds, {}});
  for (Bar& bar : bars) bar.label = seconds_text(bar.value);
  return bar_plot(fmt::format("Seconds, summed over {} threads where not wall", s.threads), bars);
}

std::string distances(const Statistics& s) {
  std::vector<double> edges;
  Histogram nearest{"to the nearest neighbour", {}}, farthest{"to the farthest of the neighbourhood", {}};
  for (const DistanceBin& bin : s.neighbor_distances) {
    if (bin.from <= 0) continue;
    edges.push_back(bin.from);
    const double octaves = std::log2(bin.to / bin.from);  // counts per octave, since bins differ in width
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

using Rows = std::vector<std::pair<std::string, std::string>>;

std::string number(std::uint64_t value) { return fmt::format("{}", value); }

/// Returns the rows of the table of inputs and outputs.
Rows rows_of_files(const RunSummary& summary) {
  const Statistics& s = summary.statistics;
  Rows rows = {{"input", summary.inputs},
               {"output", summary.output},
               {"points read", number(s.points + s.dropped)},
               {"points written", number(s.points_written)},
               {"coordinate system", summary.crs.empty() ? "not stated" : summary.crs},
               {"unit of lengths", summary.unit.empty() ? "not stated" : summary.unit}};
  if (!summary.made.empty()) {
    const auto names = summary.made | std::views::transform(&ValueSummary::name);
    rows.emplace_back("made", fmt::format("{}", fmt::join(names, ", ")));
  }
  rows.emplace_back("neighbours", s.sweeps == 0 ? "none" : s.k == 0 ? "all within the radius" : "k = " + number(s.k));
  rows.emplace_back("command", summary.command);
  rows.emplace_back("time", fmt::format("{}, {} points a second", seconds_text(s.total_seconds),
                                        short_number(static_cast<double>(s.points) / std::max(s.total_seconds, 1e-9))));
  return rows;
}

/// Returns the rows of the table of points with and without results.
Rows rows_of_counts(const RunSummary& summary) {
  const Statistics& s = summary.statistics;
  Rows rows = {{"kept", number(s.points_written)},
               {"left out by the pipeline", number(s.points - std::min(s.points, s.points_written))},
               {"not finite, dropped", number(s.dropped)},
               {"not finite, kept without results", number(s.nonfinite - std::min(s.nonfinite, s.dropped))},
               {"degenerate results", number(s.degenerate)}};
  for (const DegenerateResults& results : s.degenerate_results)
    if (results.count > 0) rows.emplace_back("degenerate in " + results.stage, number(results.count));
  if (!s.neighbor_distances.empty()) rows.emplace_back("duplicate points", number(equal_points(s)));
  if (summary.picture) rows.emplace_back("outside of the picture", number(summary.picture->outside));
  return rows;
}

Rows rows_of_engine(const RunSummary& summary) {
  const Statistics& s = summary.statistics;
  return {{"version", summary.version},
          {"certified neighbourhoods", number(s.certified)},
          {"of these recalled", number(s.recalled)},
          {"window, peak", fmt::format("{} points", s.peak_points)},
          {"window, mean", fmt::format("{:.0f} points", s.mean_points)},
          {"lifespan of a point, mean and longest",
           seconds_text(s.lifespan_mean_seconds) + ", " + seconds_text(s.lifespan_max_seconds)},
          {"memory, peak", bytes_text(s.peak_rss_bytes)},
          {"memory, budget", bytes_text(s.memory_budget_bytes)},
          {"read, spilled, written",
           bytes_text(s.bytes_read) + ", " + bytes_text(s.bytes_spilled) + ", " + bytes_text(s.bytes_written)},
          {"threads", number(s.threads)},
          {"machine", s.machine}};
}

void add_picture(const RunSummary& summary, Page& page) {
  if (!summary.picture) return page.paragraph("There is no picture, because the output is no file of points.");
  const Rendering& r = *summary.picture;
  std::string caption = "The result, coloured by " + r.color;
  if (r.is_number) caption += fmt::format(": violet {:.4g} to yellow {:.4g}", r.lo, r.hi);
  if (r.drawn < summary.statistics.points_written)
    caption += fmt::format(". Drawn are {} of {} points, so that the page takes at most a tenth of the time of the run",
                           r.drawn, summary.statistics.points_written);
  page.picture(to_png(r.picture), caption);
}

/// Returns a text like "least 0, 5 % 0.1, 25 % 0.2, median 0.3, 75 % 0.4, 95 % 0.5, greatest 1; 3 undefined".
std::string quantiles_text(const ValueSummary& m) {
  const auto& p = m.quantiles;
  std::string text = m.edges.empty() ? "no value is defined"
                                     : fmt::format(
                                           "least {:.4g}, 5 % {:.4g}, 25 % {:.4g}, median {:.4g}, 75 % {:.4g}, "
                                           "95 % {:.4g}, greatest {:.4g}",
                                           p[0], p[1], p[2], p[3], p[4], p[5], p[6]);
  if (m.undefined > 0) text += fmt::format("; {} undefined", m.undefined);
  return text;
}

void add_values(const RunSummary& summary, Page& page) {
  if (summary.made.empty()) return;
  page.heading("What was made");
  if (summary.made.front().values < summary.statistics.points_written)
    page.paragraph(fmt::format("Of {} points, evenly chosen.", summary.made.front().values));
  for (const ValueSummary& m : summary.made)
    page.figure(value_plot(m.unit.empty() ? m.name : fmt::format("{} ({})", m.name, m.unit), m.edges, m.counts),
                quantiles_text(m));
}

}  // namespace

std::vector<ValueSummary> value_summaries(const Schema& schema, std::span<const std::byte> records,
                                          std::span<const std::string> fields, std::string_view length) {
  std::vector<ValueSummary> summaries;
  for (const Field& field : schema.fields) {
    if (field.count != 1 || std::ranges::find(fields, field.name) == fields.end()) continue;
    summaries.push_back(summary_of(field, schema.stride, records));
    summaries.back().unit = unit_of_attribute(field.name, length);
  }
  return summaries;
}

std::string report_of(const RunSummary& summary) {
  Page page(summary.title);
  const Statistics& s = summary.statistics;
  page.table(rows_of_files(summary));
  for (const std::string& warning : s.warnings) page.paragraph("Warning: " + warning);
  add_picture(summary, page);
  add_values(summary, page);
  page.heading("Counts");
  page.table(rows_of_counts(summary));
  page.heading("Time");
  page.plot(times(summary));
  page.heading("Engine");
  page.plot(working_set(s));
  page.plot(distances(s));
  page.table(rows_of_engine(summary));
  return page.html();
}

}  // namespace pointsweep
