// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/statistics.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "pointsweep/formats/registry.h"

namespace pointsweep {
namespace {

nlohmann::ordered_json thinned(const std::vector<std::pair<std::uint64_t, std::uint64_t>>& series) {
  constexpr std::size_t kRows = 1000;
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  const std::size_t n = series.size(), keep = n < kRows ? n : kRows;
  for (std::size_t i = 0; i < keep; ++i) {
    const auto& [read, active] = series[keep == 1 ? 0 : i * (n - 1) / (keep - 1)];
    rows.push_back({read, active});
  }
  return rows;
}

/// Returns [{"operator": "knn", "series": [[points read, points waiting], ...]}, ...].
nlohmann::ordered_json buffers(const Statistics& s) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (const auto& [name, series] : s.buffers) out.push_back({{"operator", name}, {"series", thinned(series)}});
  return out;
}

/// Makes the name of a stage unique among the names `used` of the chain, and adds it: "normals", "normals_2".
std::string unique_name(const std::string& name, std::set<std::string>& used) {
  std::string unique = name;
  for (int again = 2; !used.insert(unique).second; ++again) unique = fmt::format("{}_{}", name, again);
  return unique;
}

/// Returns [{"stage": "normals", "count": 2, "rows": [3, 17]}, ...], without stages that have no degenerate points.
nlohmann::ordered_json degenerate_rows(const Statistics& s) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  std::set<std::string> used;
  for (const DegenerateResults& results : s.degenerate_results) {
    const std::string stage = unique_name(results.stage, used);
    if (results.count > 0) out.push_back({{"stage", stage}, {"count", results.count}, {"rows", results.rows}});
  }
  return out;
}

nlohmann::ordered_json counts(const ReferenceCounts& r) {
  return {{"complete", r.complete},
          {"incomplete", r.incomplete},
          {"write_seconds", r.write_seconds},
          {"audit_seconds", r.audit_seconds}};
}

/// Returns the bin of distance 0 if it has counts, and all bins from the first to the last of the others that have
/// counts.
std::vector<DistanceBin> bins_of(const NeighborDistances& distances) {
  const auto bin = [&](std::size_t i) {
    return DistanceBin{std::sqrt(DistanceHistogram::lower_end2(i)), std::sqrt(DistanceHistogram::lower_end2(i + 1)),
                       distances.nearest.count(i), distances.farthest.count(i)};
  };
  const auto empty = [&](std::size_t i) { return distances.nearest.count(i) + distances.farthest.count(i) == 0; };
  std::vector<DistanceBin> bins;
  if (!empty(0)) bins.push_back(bin(0));
  std::size_t first = 1, end = DistanceHistogram::kBins - 1;
  while (first < end && empty(first)) ++first;
  while (first < end && empty(end - 1)) --end;
  for (std::size_t i = first; i < end; ++i) bins.push_back(bin(i));
  return bins;
}

}  // namespace

void add_stages(Statistics& to, const SweepPlan& plan, const std::vector<double>& seconds,
                const std::vector<DegenerateRows>& degenerate) {
  for (std::size_t i = 0; i < plan.stages.size(); ++i) {
    const std::string name = name_of(plan.stages[i].op);
    to.operator_seconds.emplace_back(name, seconds[i]);
    to.degenerate_results.push_back({name, degenerate[i].count(), degenerate[i].lowest()});
    to.degenerate += degenerate[i].count();
  }
}

// `certified` becomes the least count of all sweeps, which is an upper bound of the points certified in every sweep.
void add_sweep(Statistics& to, const SweepPlan& plan, const SweepStatistics& sweep) {
  to.certified = to.sweeps == 0 ? sweep.certified : std::min(to.certified, sweep.certified);
  to.recalled += sweep.recalled;
  to.recall_seconds += sweep.recall_seconds;
  to.read_seconds += sweep.read_seconds, to.search_seconds += sweep.search_seconds;
  add_stages(to, plan, sweep.stage_seconds, sweep.degenerate);
  const std::uint64_t read_before = to.series.empty() ? 0 : to.series.back().first;
  const std::uint64_t read = sweep.series.empty() ? 0 : sweep.series.back().first;
  const auto mean = [](double a, std::size_t of_a, double b, std::size_t of_b) {
    const auto p = static_cast<double>(of_a), q = static_cast<double>(of_b);
    return p == 0 ? b : q == 0 ? a : (p * a + q * b) / (p + q);
  };
  to.peak_points = std::max(to.peak_points, sweep.peak_points);
  to.mean_points = mean(to.mean_points, to.series.size(), sweep.mean_points, sweep.series.size());
  to.lifespan_mean_seconds = mean(to.lifespan_mean_seconds, read_before, sweep.lifespan_mean, read);
  to.lifespan_max_seconds = std::max(to.lifespan_max_seconds, sweep.lifespan_max);
  for (const auto& [points_read, active] : sweep.series) to.series.emplace_back(read_before + points_read, active);
  for (auto [name, series] : sweep.buffers) {
    for (auto& [points_read, waiting] : series) points_read += read_before;
    to.buffers.emplace_back(name, std::move(series));
  }
  if (to.sweeps == 0) to.neighbor_distances = bins_of(sweep.distances);
  ++to.sweeps;
}

std::string to_json(const Statistics& s) {
  nlohmann::ordered_json distances = nlohmann::ordered_json::array();
  for (const DistanceBin& bin : s.neighbor_distances) {
    distances.push_back({{"from", bin.from}, {"to", bin.to}, {"nearest", bin.nearest}, {"farthest", bin.farthest}});
  }
  nlohmann::ordered_json operators = nlohmann::ordered_json::object();
  std::set<std::string> used;
  for (const auto& [name, seconds] : s.operator_seconds) operators[unique_name(name, used)] = seconds;
  nlohmann::ordered_json json = {
      {"points", s.points},
      {"points_written", s.points_written},
      {"files_written", s.files_written},
      {"sweeps", s.sweeps},
      {"k", s.k},
      {"certified", s.certified},
      {"recalled", s.recalled},
      {"recall_share", s.total_seconds > 0 ? s.recall_seconds / s.total_seconds : 0},
      {"degenerate", s.degenerate},
      {"degenerate_rows", degenerate_rows(s)},
      {"nonfinite", s.nonfinite},
      {"nonfinite_dropped", s.dropped},
      {"nonfinite_rows", s.nonfinite_rows},
      {"seconds",
       {{"total", s.total_seconds},
        {"order", s.order_seconds},
        {"read", s.read_seconds},
        {"search", s.search_seconds},
        {"recall", s.recall_seconds},
        {"write", s.write_seconds},
        {"operators", operators}}},
      {"ordering", s.ordering},
      {"bytes",
       {{"read", s.bytes_read},
        {"spilled", s.bytes_spilled},
        {"spilled_ordering", s.bytes_spilled_ordering},
        {"spilled_decoding", s.bytes_spilled_decoding},
        {"written", s.bytes_written}}},
      {"peak_rss_bytes", s.peak_rss_bytes},
      {"memory_budget_bytes", s.memory_budget_bytes},
      {"working_set", {{"peak_points", s.peak_points}, {"mean_points", s.mean_points}, {"series", thinned(s.series)}}},
      {"buffers", buffers(s)},
      {"lifespan_seconds", {{"mean", s.lifespan_mean_seconds}, {"max", s.lifespan_max_seconds}}},
      {"threads", s.threads},
      {"machine", s.machine},
      {"warnings", s.warnings},
  };
  if (s.reference) json["reference"] = counts(*s.reference);
  if (!distances.empty()) json["neighbor_distances"] = std::move(distances);
  return json.dump(2) + "\n";
}

std::string machine_description() {
  std::ifstream file("/proc/cpuinfo");
  std::string name = "unknown processor";
  for (std::string line; std::getline(file, line);) {
    const auto colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) {
      name = line.substr(colon + 2);
      break;
    }
  }
  return fmt::format("{}, {} cores", name, std::thread::hardware_concurrency());
}

std::uint64_t peak_resident_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    std::uint64_t kilobytes;
    if (word == "VmHWM:" && status >> kilobytes) return kilobytes * 1024;
  }
  rusage usage{};  // a fallback, which includes the peak of the process before exec()
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

void write_states(const std::vector<PointState>& states, const std::filesystem::path& path, bool overwrite) {
  OutputPlan plan{.path = path, .schema = {}, .count = states.size(), .extras = {}, .overwrite = overwrite};
  plan.schema.append("state", Type::u8);
  const std::unique_ptr<Writer> writer = array_format().create(plan);
  writer->write(std::as_bytes(std::span(states)));
  writer->finish();
}

}  // namespace pointsweep
