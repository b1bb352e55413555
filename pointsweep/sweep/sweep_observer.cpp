// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/sweep_observer.h"

#include <algorithm>

namespace pointsweep {
namespace {

/// Returns empty series named after the operators of each step, e.g. "knn, normals" and "curvature, splats", and a last
/// series named "finished".
decltype(SweepStatistics::buffers) named_buffers(const SweepPlan& plan) {
  decltype(SweepStatistics::buffers) buffers;
  for (std::size_t step = 0; step < plan.step_count(); ++step) {
    std::string name = step == 0 ? "knn" : "";
    for (std::size_t s = plan.steps[step]; s < plan.steps[step + 1]; ++s)
      name += (name.empty() ? "" : ", ") + name_of(plan.stages[s].op);
    buffers.push_back({name, {}});
  }
  buffers.push_back({"finished", {}});
  return buffers;
}

}  // namespace

SweepObserver::SweepObserver(const Stream& stream, const SweepPlan& plan, const SweepOptions& options)
    : stream_(stream), plan_(plan), options_(options), half_way_noted_(options.half_way == nullptr) {}

void SweepObserver::resumed(const SweepProgress& from, std::uint32_t first_slab) {
  statistics_.recalled = from.recalled;
  statistics_.recalled_slabs = recalled_slabs_before_ = from.recalled_slabs;
  statistics_.peak_points = from.peak_points;
  for (std::uint32_t slab = 0; slab < first_slab; ++slab) points_read_ += stream_.slabs()[slab].count;
}

void SweepObserver::slab_was_read(std::uint32_t slab, const std::vector<std::unique_ptr<WindowCell>>& cells) {
  points_read_ += stream_.slabs()[slab].count;
  points_swept_ += stream_.slabs()[slab].count;
  if (half_way_noted_) return;
  for (const auto& cell : cells) note_state(cell->cell, PointState::gone);
}

void SweepObserver::steps_were_taken(const Window& window) {
  const std::uint64_t active = window.points();
  statistics_.peak_points = std::max(statistics_.peak_points, active);
  active_sum_ += static_cast<double>(active);
  statistics_.series.emplace_back(points_read_, active);
  note_buffers(window);
  if (options_.progress) options_.progress(points_read_, active);
}

void SweepObserver::note_buffers(const Window& window) {
  std::vector<std::uint64_t> waiting(plan_.step_count() + 1, 0);
  for (const std::uint32_t slot : window.occupied()) {
    const WindowCell& cell = window.at(slot);
    waiting[cell.steps_done] += cell.cell.size();
  }
  if (statistics_.buffers.empty()) statistics_.buffers = named_buffers(plan_);
  for (std::size_t b = 0; b < waiting.size(); ++b) statistics_.buffers[b].second.emplace_back(points_read_, waiting[b]);
}

void SweepObserver::cells_were_dropped(const Window& window) {
  if (half_way_noted_) return;
  std::uint64_t all = 0;
  for (const auto& slab : stream_.slabs()) all += slab.count;
  if (points_read_ >= all - points_read_) note_half_way(window);
}

/// Records the states of the points in the window. All other points that were read have left the window.
void SweepObserver::note_half_way(const Window& window) {
  half_way_noted_ = true;
  for (const std::uint32_t slot : window.occupied()) {
    const WindowCell& cell = window.at(slot);
    const bool finished = cell.steps_done == plan_.step_count();
    note_state(cell.cell, cell.steps_done == 0 ? PointState::waiting
                          : finished           ? PointState::kept
                                               : PointState::searched);
  }
}

void SweepObserver::note_state(const Cell& cell, PointState state) {
  for (std::uint32_t i = 0; i < cell.size(); ++i) (*options_.half_way)[cell.row[i]] = state;
}

void SweepObserver::recalled(std::uint64_t points, const SlabsRead& read, std::uint64_t left) {
  statistics_.recalled += points;
  statistics_.recalled_slabs = recalled_slabs_before_ + read.slabs;
  statistics_.recalled_bytes = read.bytes;
  if (options_.progress) options_.progress(points_read_, left);
}

SweepStatistics SweepObserver::finish(const Window& window, const std::vector<Worker>& workers) {
  statistics_.stage_seconds.assign(plan_.stages.size(), 0);
  statistics_.degenerate.resize(plan_.stages.size());
  for (const Worker& worker : workers) {
    statistics_.certified += worker.certified;
    add_rows(statistics_.degenerate, worker.tally.degenerate);
    if (worker.tally.distances) statistics_.distances.add(*worker.tally.distances);
    statistics_.search_seconds += worker.search_seconds;
    for (const StageTally* tally : {&worker.tally, &worker.halo})
      for (std::size_t s = 0; s < tally->seconds.size(); ++s) statistics_.stage_seconds[s] += tally->seconds[s];
  }
  statistics_.mean_points = active_sum_ / static_cast<double>(std::max<std::size_t>(statistics_.series.size(), 1));
  statistics_.lifespan_mean = window.lifespan_sum() / static_cast<double>(std::max<std::uint64_t>(points_swept_, 1));
  statistics_.lifespan_max = window.lifespan_max();
  return std::move(statistics_);
}

}  // namespace pointsweep
