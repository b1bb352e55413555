// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/statistics.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

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

}  // namespace

std::string to_json(const Statistics& s) {
  nlohmann::ordered_json operators = nlohmann::ordered_json::object();
  for (const auto& [name, seconds] : s.operator_seconds) {
    std::string key = name;
    for (int again = 2; operators.contains(key); ++again) key = fmt::format("{}_{}", name, again);
    operators[key] = seconds;
  }
  const nlohmann::ordered_json json = {
      {"points", s.points},
      {"k", s.k},
      {"certified", s.certified},
      {"recalled", s.recalled},
      {"degenerate", s.degenerate},
      {"nonfinite", s.nonfinite},
      {"seconds",
       {{"total", s.total_seconds},
        {"order", s.order_seconds},
        {"read", s.read_seconds},
        {"search", s.search_seconds},
        {"write", s.write_seconds},
        {"operators", operators}}},
      {"bytes", {{"read", s.bytes_read}, {"spilled", s.bytes_spilled}, {"written", s.bytes_written}}},
      {"peak_rss_bytes", s.peak_rss_bytes},
      {"memory_budget_bytes", s.memory_budget_bytes},
      {"working_set", {{"peak_points", s.peak_points}, {"mean_points", s.mean_points}, {"series", thinned(s.series)}}},
      {"lifespan_seconds", {{"mean", s.lifespan_mean_seconds}, {"max", s.lifespan_max_seconds}}},
      {"threads", s.threads},
      {"machine", s.machine},
      {"warnings", s.warnings},
  };
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
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

}  // namespace pointsweep
