// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/sweep.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <optional>
#include <span>

#include "pointsweep/prefetch.h"
#include "pointsweep/sweep/cell_runner.h"
#include "pointsweep/sweep/recall.h"
#include "pointsweep/sweep/sweep_restart.h"
#include "pointsweep/threads.h"

namespace pointsweep {

namespace {

/// "knn, normals", "curvature, splats", "finished"
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

class Sweep {
 public:
  Sweep(const Stream& stream, const SweepPlan& plan, Sink& sink, const SweepOptions& options)
      : stream_(stream),
        plan_(plan),
        sink_(sink),
        options_(options),
        loader_(stream, plan, options.cell_points),
        frontier_(stream.slabs(), stream.axis()),
        window_(plan, frontier_),
        runner_(plan, window_, frontier_, sink, {options.cells_bytes, options.lists_bytes}),
        workers_(thread_count()) {
    for (Worker& worker : workers_) {
      if (options.count_distances) worker.tally.distances = std::make_unique<NeighborDistances>();
      if (options.edges != nullptr) worker.tally.edges = std::make_unique<EdgeEmitter>(*options.edges);
    }
  }

  /// The paper's main loop: while the stream has points, read some; then let every operator in turn pull what has
  /// become ready; what is finished leaves. At the end, whatever had to be deferred is recalled.
  SweepStatistics run() {
    const std::size_t slabs = stream_.slabs().size();
    const std::uint32_t first = restart();
    Prefetch<LoadedSlab> loaded([this](std::size_t slab) { return load(slab); }, first, slabs, options_.read_ahead);
    for (std::uint32_t slab = first; slab < slabs; ++slab) {
      read(loaded.next(), slab);
      for (std::uint32_t step = 0; step < plan_.step_count(); ++step) pull(step);
      take_note();
      window_.drop();
      if (options_.half_way != nullptr && !half_way_noted_) note_half_way();
      keep_progress();
    }
    statistics_.read_seconds = read_seconds_;
    recall();
    refused().throw_if_any();
    return gather_statistics();
  }

 private:
  /// Goes back to where the run is to be resumed, and returns the slab to read first.
  std::uint32_t restart() {
    if (options_.resume_from == nullptr) return 0;
    const SweepProgress& from = *options_.resume_from;
    restart_.emplace(from, stream_, plan_);
    restart_->restore(loader_, window_, frontier_, sink_);
    workers_.front().deferred = from.deferred;
    workers_.front().certified = from.certified;
    workers_.front().tally.degenerate = from.degenerate;
    statistics_.recalled = from.recalled;
    statistics_.recalled_slabs = from.recalled_slabs;
    statistics_.peak_points = from.peak_points;
    for (std::uint32_t slab = 0; slab < restart_->first_slab(); ++slab) points_read_ += stream_.slabs()[slab].count;
    return restart_->first_slab();
  }

  LoadedSlab load(std::size_t slab) {
    const auto start = std::chrono::steady_clock::now();
    LoadedSlab loaded = loader_.load(static_cast<std::uint32_t>(slab), sink_.wants_records());
    read_seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return loaded;
  }

  void read(LoadedSlab loaded, std::uint32_t slab) {
    frontier_.slab_was_read();
    points_read_ += stream_.slabs()[slab].count;
    points_swept_ += stream_.slabs()[slab].count;
    if (options_.resume_from != nullptr && slab < options_.resume_from->slabs_read)
      restart_->prepare(slab, loaded, sink_);
    else if (sink_.wants_records())
      sink_.slab_read(slab, std::move(loaded.records));
    for (auto& cell : loaded.cells) {
      if (options_.half_way != nullptr && !half_way_noted_) note_state(cell->cell, PointState::gone);
      window_.admit(std::move(cell));
    }
  }

  void pull(std::uint32_t step) {
    const std::vector<std::uint32_t> ready = window_.ready_for(step);
    parallel_for(ready.size(), [&](std::size_t i, unsigned worker) { runner_.run(ready[i], step, workers_[worker]); });
    for (const std::uint32_t slot : ready) {
      WindowCell& cell = window_.at(slot);
      if (!cell.deferred.empty()) cell.deferred_before = cell.deferred;
    }
  }

  void take_note() {
    const std::uint64_t active = window_.points();
    statistics_.peak_points = std::max(statistics_.peak_points, active);
    active_sum_ += static_cast<double>(active);
    statistics_.series.emplace_back(points_read_, active);
    note_buffers();
    if (options_.progress) options_.progress(points_read_, active);
  }

  void note_buffers() {
    std::vector<std::uint64_t> waiting(plan_.step_count() + 1, 0);
    for (const std::uint32_t slot : window_.occupied()) {
      const WindowCell& cell = window_.at(slot);
      waiting[cell.steps_done] += cell.cell.size();
    }
    if (statistics_.buffers.empty()) statistics_.buffers = named_buffers(plan_);
    for (std::size_t b = 0; b < waiting.size(); ++b)
      statistics_.buffers[b].second.emplace_back(points_read_, waiting[b]);
  }

  void note_state(const Cell& cell, PointState state) {
    for (std::uint32_t i = 0; i < cell.size(); ++i) (*options_.half_way)[cell.row[i]] = state;
  }

  /// What was read is gone, but for what is in the window.
  void note_half_way() {
    std::uint64_t all = 0;
    for (const auto& slab : stream_.slabs()) all += slab.count;
    if (points_read_ < all - points_read_) return;
    half_way_noted_ = true;
    for (const std::uint32_t slot : window_.occupied()) {
      const WindowCell& cell = window_.at(slot);
      const bool finished = cell.steps_done == plan_.step_count();
      note_state(cell.cell, cell.steps_done == 0 ? PointState::waiting
                            : finished           ? PointState::kept
                                                 : PointState::searched);
    }
  }

  /// Not while slabs are read again: what had been finished in those still to come would be forgotten.
  void keep_progress() {
    const bool reads_again =
        options_.resume_from != nullptr && frontier_.slabs_read() < options_.resume_from->slabs_read;
    if (options_.keeper == nullptr || reads_again || !options_.keeper->wants_progress() || refused().any()) return;
    options_.keeper->keep(progress());
  }

  FirstRowError refused() const {
    FirstRowError first;
    for (const Worker& worker : workers_) first.note(worker.tally.refused), first.note(worker.halo.refused);
    return first;
  }

  SweepProgress progress() const {
    SweepProgress p;
    p.slabs_read = static_cast<std::uint32_t>(frontier_.slabs_read());
    for (const Worker& worker : workers_) {
      p.deferred.insert(p.deferred.end(), worker.deferred.begin(), worker.deferred.end());
      p.certified += worker.certified;
      add_rows(p.degenerate, worker.tally.degenerate);
    }
    p.recalled = statistics_.recalled;
    p.recalled_slabs = statistics_.recalled_slabs;
    p.peak_points = statistics_.peak_points;
    for (std::uint32_t slab = 0; slab < p.slabs_read; ++slab)
      for (const DroppedCell& cell : frontier_.dropped_of(slab)) p.dropped.push_back({slab, cell});
    frontier_.for_each_saturated_location([&](Vec3 place, std::uint64_t row) {
      p.saturated_locations.push_back({place, row});
    });
    if (p.slabs_read == stream_.slabs().size()) return p;  // the recall needs nothing of the window
    for (const std::uint32_t slot : window_.occupied()) {
      const WindowCell& cell = window_.at(slot);
      const bool finished = cell.was_finished || cell.steps_done == plan_.step_count();
      p.window.push_back({cell.slab, cell.number, cell.cell.size(), finished, cell.reach});
    }
    return p;
  }

  /// The deferred points of all threads, against the order of the stream: the recall begins at the end.
  std::vector<DeferredPoint> take_deferred() {
    std::vector<DeferredPoint> deferred;
    for (Worker& worker : workers_) {
      deferred.insert(deferred.end(), worker.deferred.begin(), worker.deferred.end());
      worker.deferred = {};
    }
    std::ranges::sort(deferred, [](const DeferredPoint& a, const DeferredPoint& b) {
      return a.slab != b.slab ? a.slab > b.slab : a.row > b.row;
    });
    return deferred;
  }

  /// Group by group; the window is empty, so that they may take its memory.
  void recall() {
    const auto start = std::chrono::steady_clock::now();
    Recall recall(stream_, plan_, loader_, frontier_,
                  {options_.recall_bytes, options_.lists_bytes, std::max<std::size_t>(1, options_.read_ahead)},
                  workers_);
    const std::uint64_t slabs_before = statistics_.recalled_slabs;
    Worker& worker = workers_.front();
    worker.deferred = take_deferred();
    while (!worker.deferred.empty()) {
      const std::size_t points = recall.run(worker.deferred, sink_);
      worker.deferred.erase(worker.deferred.end() - static_cast<std::ptrdiff_t>(points), worker.deferred.end());
      worker.certified += points;
      statistics_.recalled += points;
      statistics_.recalled_slabs = slabs_before + recall.slabs_read();
      if (options_.progress) options_.progress(points_read_, worker.deferred.size());
      keep_progress();
    }
    statistics_.recall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }

  SweepStatistics gather_statistics() {
    statistics_.stage_seconds.assign(plan_.stages.size(), 0);
    statistics_.degenerate.resize(plan_.stages.size());
    for (const Worker& worker : workers_) {
      statistics_.certified += worker.certified;
      add_rows(statistics_.degenerate, worker.tally.degenerate);
      if (worker.tally.distances) statistics_.distances.add(*worker.tally.distances);
      statistics_.search_seconds += worker.search_seconds;
      for (const StageTally* tally : {&worker.tally, &worker.halo})
        for (std::size_t s = 0; s < tally->seconds.size(); ++s) statistics_.stage_seconds[s] += tally->seconds[s];
    }
    statistics_.mean_points = active_sum_ / static_cast<double>(std::max<std::size_t>(statistics_.series.size(), 1));
    statistics_.lifespan_mean = window_.lifespan_sum() / static_cast<double>(std::max<std::uint64_t>(points_swept_, 1));
    statistics_.lifespan_max = window_.lifespan_max();
    return std::move(statistics_);
  }

  const Stream& stream_;
  const SweepPlan& plan_;
  Sink& sink_;
  const SweepOptions& options_;
  const SlabLoader loader_;
  Frontier frontier_;
  Window window_;
  const CellRunner runner_;
  std::vector<Worker> workers_;
  SweepStatistics statistics_;
  std::optional<SweepRestart> restart_;
  std::uint64_t points_read_ = 0, points_swept_ = 0;  ///< in all; by this process
  bool half_way_noted_ = false;
  double active_sum_ = 0;
  std::atomic<double> read_seconds_ = 0;  ///< loading slabs, all threads
};

}  // namespace

SweepStatistics sweep(const Stream& stream, const SweepPlan& plan, Sink& sink, const SweepOptions& options) {
  return Sweep(stream, plan, sink, options).run();
}

}  // namespace pointsweep
