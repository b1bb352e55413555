// SPDX-License-Identifier: MIT
/// Saves the progress of a sweep, and restores it in another sweep, perhaps of another process (docs/adr/0008).
///
/// A restart restores the cells of the window, and the boxes of dropped cells in the frontier. If later steps read
/// values that earlier steps have made for neighbours, the last slabs are read again, and their cells take the steps
/// once more (finished cells without the last step), which makes these values again; results delivered earlier are not
/// delivered again. No value depends on the number of slabs read again: points that cannot be certified are recalled.
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "pointsweep/sweep/slab_loader.h"
#include "pointsweep/sweep/sweep.h"
#include "pointsweep/sweep/window.h"
#include "pointsweep/sweep/worker.h"

namespace pointsweep {

/// Returns the progress of a sweep between two turns, or between two groups of its recall.
SweepProgress progress_of(const Stream& stream, const SweepPlan& plan, const Frontier& frontier, const Window& window,
                          const std::vector<Worker>& workers, const SweepStatistics& statistics);

class SweepRestart {
 public:
  /// All arguments must outlive the restart.
  SweepRestart(const SweepProgress& from, const Stream& stream, const SweepPlan& plan);

  /// Returns the number of the slab with which reading begins. Slabs for which was_read() is true are read for the
  /// second time.
  std::uint32_t first_slab() const { return first_slab_; }
  /// Returns whether the earlier sweep had read the slab.
  bool was_read(std::uint32_t slab) const { return slab < from_.slabs_read; }
  /// Restores the state of all slabs before first_slab(), and gives the counts and deferred points of the earlier sweep
  /// to `worker`.
  void restore(const SlabLoader& loader, Window& window, Frontier& frontier, Sink& sink, Worker& worker) const;
  /// Prepares a slab that was read again, before its cells go into the window: marks the cells that the earlier sweep
  /// had finished, and if the sink takes records, passes to `sink` the records of the slab, its deferred points and the
  /// number of its finished points.
  void prepare(std::uint32_t slab, LoadedSlab& loaded, Sink& sink) const;

 private:
  std::uint32_t slab_to_begin_with() const;
  bool was_in_window(std::uint32_t slab) const;
  void mark(WindowCell& cell) const;
  void tell(std::uint32_t slab, std::vector<std::byte> records, std::uint64_t unfinished, Sink& sink) const;

  const SweepProgress& from_;
  const Stream& stream_;
  const SweepPlan& plan_;
  std::uint32_t first_slab_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, WindowedCell> window_;  ///< cells of the window by slab and number
  std::map<std::uint32_t, std::vector<std::uint32_t>> deferred_;  ///< for each slab, indices of its deferred points
};

}  // namespace pointsweep
