// SPDX-License-Identifier: MIT
/// The paper's algorithm on points in memory.
#pragma once

#include <cstring>
#include <vector>

#include "pointsweep/order/survey.h"
#include "reference/reference.h"
#include "tests/order/cloud_source.h"

namespace pointsweep::reference {

struct PointsRun {
  Statistics statistics;
  std::vector<std::vector<std::byte>> results;  ///< by row; empty where a point is in no slab
  std::vector<bool> complete;                   ///< by row
  std::vector<std::uint64_t> rows;              ///< in the order written
};

inline PointsRun run_on_points(const std::vector<Vec3>& points, const Task& task, std::uint64_t slab_points = 500,
                               const Options& options = {.memory_bytes = 1u << 30, .progress = {}}) {
  const CloudSource<double> cloud(points);
  const Survey about = survey(cloud.source, std::nullopt, true);
  StreamOptions slabs;
  slabs.axis = about.axis;
  slabs.slab_points = slab_points;
  const Stream stream(cloud.source, about, slabs);
  std::size_t bytes = 0;
  for (const Attribute& a : task.kept) bytes += a.bytes();
  PointsRun out{.statistics = {},
                .results = std::vector<std::vector<std::byte>>(points.size()),
                .complete = std::vector<bool>(points.size()),
                .rows = {}};
  const auto write = [&](const Written& w) {
    out.results[w.row].assign(w.results, w.results + bytes);
    out.complete[w.row] = w.complete;
    out.rows.push_back(w.row);
  };
  out.statistics = run(stream, task, write, options);
  return out;
}

/// Keeps the last version of everything made.
inline Task task_of(std::size_t k, double radius, const std::vector<std::shared_ptr<const Operator>>& operators) {
  Task task{.reach = {k, radius * radius}, .operators = operators, .kept = {}};
  for (const auto& op : operators) {
    for (const Attribute& made : op->contract().makes) {
      const auto same = [&](const Attribute& a) { return a.name == made.name; };
      if (std::none_of(task.kept.begin(), task.kept.end(), same)) task.kept.push_back(made);
    }
  }
  return task;
}

}  // namespace pointsweep::reference
