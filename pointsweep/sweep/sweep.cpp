// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/sweep.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <optional>

#include "pointsweep/sweep/cell_runner.h"
#include "pointsweep/sweep/recall.h"
#include "pointsweep/sweep/sweep_observer.h"
#include "pointsweep/sweep/sweep_restart.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

class Sweep {
 public:
  Sweep(const Stream& stream, const SweepPlan& plan, Sink& sink, const SweepOptions& options)
      : stream_(stream),
        plan_(plan),
        sink_(sink),
        options_(options),
        loader_(stream, plan, options.cell_points),
        frontier_(stream.slabs(), stream.axis(), stream.swept_slabs()),
        window_(plan, frontier_),
        runner_(plan, window_, frontier_, sink, {options.cells_bytes, options.lists_bytes}),
        workers_(thread_count()),
        observer_(stream, plan, options) {
    for (Worker& worker : workers_) {
      if (options.count_distances) worker.tally.distances = std::make_unique<NeighborDistances>();
      if (options.edges != nullptr) worker.tally.edges = std::make_unique<EdgeEmitter>(*options.edges);
    }
    if (options.resume_from != nullptr) restart_.emplace(*options.resume_from, stream, plan);
  }

  /// The paper's main loop. In each turn some slabs are read; then every step in order processes the cells that have
  /// become ready; then cells that are no longer needed are dropped. At the end, all deferred points are recalled.
  SweepStatistics run() {
    const std::uint32_t first = restart(), slabs = static_cast<std::uint32_t>(stream_.swept_slabs());
    Prefetch<LoadedSlab> loaded([this](std::size_t slab) { return load(slab); }, first, slabs, options_.read_ahead);
    for (std::uint32_t slab = first; slab < slabs;) {
      const std::uint32_t end = std::min(slabs, slab + options_.slabs_per_turn);
      for (; slab < end; ++slab) read(slab, loaded.next());
      take_steps();
    }
    const double recall_seconds = recall();
    refused().throw_if_any();
    SweepStatistics statistics = observer_.finish(window_, workers_);
    statistics.read_seconds = read_seconds_;
    statistics.recall_seconds = recall_seconds;
    return statistics;
  }

 private:
  /// Restores the progress of a resumed run, and returns the slab to read first.
  std::uint32_t restart() {
    if (!restart_) return 0;
    restart_->restore(loader_, window_, frontier_, sink_, workers_.front());
    observer_.resumed(*options_.resume_from, restart_->first_slab());
    return restart_->first_slab();
  }

  LoadedSlab load(std::size_t slab) {
    const auto start = std::chrono::steady_clock::now();
    LoadedSlab loaded = loader_.load(static_cast<std::uint32_t>(slab), sink_.wants_records());
    read_seconds_ += seconds_since(start);
    return loaded;
  }

  void read(std::uint32_t slab, LoadedSlab loaded) {
    frontier_.slab_was_read();
    observer_.slab_was_read(slab, loaded.cells);
    if (restart_ && restart_->was_read(slab))
      restart_->prepare(slab, loaded, sink_);
    else if (sink_.wants_records())
      sink_.slab_read(slab, std::move(loaded.records));
    for (auto& cell : loaded.cells) window_.admit(std::move(cell));
  }

  void take_steps() {
    for (std::uint32_t step = 0; step < plan_.step_count(); ++step) take(step);
    observer_.steps_were_taken(window_);
    window_.drop();
    observer_.cells_were_dropped(window_);
    keep_progress();
  }

  void take(std::uint32_t step) {
    const std::vector<std::uint32_t> ready = window_.ready_for(step);
    parallel_for(ready.size(), [&](std::size_t i, unsigned worker) { runner_.run(ready[i], step, workers_[worker]); });
    if (step == 0) window_.note_searched(ready);
    for (const std::uint32_t slot : ready) {
      WindowCell& cell = window_.at(slot);
      if (!cell.deferred.empty()) cell.deferred_before = cell.deferred;
    }
  }

  /// Gives the progress to the keeper if the keeper wants it, except while a resumed run reads slabs again: finished
  /// points of slabs that are still to be read again would be lost. After an error of a row, no progress is kept.
  void keep_progress() {
    const bool reads_again = restart_ && restart_->was_read(static_cast<std::uint32_t>(frontier_.slabs_read()));
    if (options_.keeper == nullptr || reads_again || !options_.keeper->wants_progress() || refused().any()) return;
    options_.keeper->keep(progress_of(stream_, plan_, frontier_, window_, workers_, observer_.so_far()));
  }

  /// Returns the error of the loader or a stage that refused a row; without one, the error of the sink; empty if
  /// neither failed.
  FirstRowError refused() const {
    FirstRowError by_stage = loader_.refused(), by_sink;
    for (const Worker& worker : workers_) {
      by_stage.note(worker.tally.refused);
      by_sink.note(worker.unwritten);
    }
    return by_stage.any() ? by_stage : by_sink;
  }

  /// Finishes the deferred points, and returns the seconds that this took. The recall uses the memory of the window,
  /// which is empty by now.
  double recall() {
    const auto start = std::chrono::steady_clock::now();
    frontier_.leave_unread_slabs();
    const std::size_t slabs_at_once = std::max<std::size_t>(1, options_.read_ahead);
    Recall recall(stream_, plan_, loader_, frontier_,
                  {options_.recall_bytes, options_.lists_bytes, options_.spare_bytes, slabs_at_once}, workers_);
    recall.run(sink_, [&](std::size_t points, std::size_t left) {
      observer_.recalled(points, recall.slabs_read(), left);
      keep_progress();
    });
    return seconds_since(start);
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
  SweepObserver observer_;
  std::optional<SweepRestart> restart_;
  std::atomic<double> read_seconds_ = 0;  ///< seconds of loading slabs, summed over threads
};

}  // namespace

SweepStatistics sweep(const Stream& stream, const SweepPlan& plan, Sink& sink, const SweepOptions& options) {
  return Sweep(stream, plan, sink, options).run();
}

}  // namespace pointsweep
