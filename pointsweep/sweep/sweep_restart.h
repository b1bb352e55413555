// SPDX-License-Identifier: MIT
/// Takes down how far a sweep has come, and puts another sweep, of another process perhaps, back to that place
/// (docs/adr/0008).
///
/// The cells that were in the window come back to it, and the boxes of dropped cells to the frontier. Where later steps
/// look at what earlier steps made, the last slabs are read again and their cells go through all steps once more, for
/// others to look at; results that had been handed over are not handed over again. No value depends on how far this
/// goes back: points that cannot be certified are recalled.
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

  /// Slabs are to be read from here on, some of them for the second time.
  std::uint32_t first_slab() const { return first_slab_; }
  /// Returns whether the slab had been read before.
  bool was_read(std::uint32_t slab) const { return slab < from_.slabs_read; }
  /// Brings back all that is known of the slabs before the first, and gives the counts and deferred points of the other
  /// sweep to a worker.
  void restore(const SlabLoader& loader, Window& window, Frontier& frontier, Sink& sink, Worker& worker) const;
  /// Prepares a slab that was read again, before its cells go into the window: marks the cells that had been finished,
  /// and tells the sink.
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
  std::map<std::pair<std::uint32_t, std::uint32_t>, WindowedCell> window_;  ///< by slab and number
  std::map<std::uint32_t, std::vector<std::uint32_t>> deferred_;            ///< by slab: indices in it
};

}  // namespace pointsweep
