// SPDX-License-Identifier: MIT
/// Observation of a sweep: statistics, series of the sizes of the window and the buffers, and the state of each point
/// when half of the points have been read.
#pragma once

#include <cstdint>
#include <vector>

#include "pointsweep/sweep/region.h"
#include "pointsweep/sweep/sweep.h"
#include "pointsweep/sweep/window.h"
#include "pointsweep/sweep/worker.h"

namespace pointsweep {

/// Collects statistics and reports progress. Only the thread of the sweep calls its functions, and no result depends on
/// them.
class SweepObserver {
 public:
  SweepObserver(const Stream& stream, const SweepPlan& plan, const SweepOptions& options);

  /// Records that the sweep continues from `from` and reads the slabs from `first_slab` on.
  void resumed(const SweepProgress& from, std::uint32_t first_slab);
  void slab_was_read(std::uint32_t slab, const std::vector<std::unique_ptr<WindowCell>>& cells);
  /// Must be called when all steps of a turn have been taken, before cells are dropped from the window.
  void steps_were_taken(const Window& window);
  void cells_were_dropped(const Window& window);
  /// Records that the recall has finished `points` more points. `read`: all slabs that the recall has read so far.
  /// `left`: points still to be finished.
  void recalled(std::uint64_t points, const SlabsRead& read, std::uint64_t left);

  const SweepStatistics& so_far() const { return statistics_; }
  /// Returns the statistics of the sweep after its end, except the seconds of reading and of the recall.
  SweepStatistics finish(const Window& window, const std::vector<Worker>& workers);

 private:
  void note_buffers(const Window& window);
  void note_state(const Cell& cell, PointState state);
  void note_half_way(const Window& window);

  const Stream& stream_;
  const SweepPlan& plan_;
  const SweepOptions& options_;
  SweepStatistics statistics_;
  std::uint64_t points_read_ = 0, points_swept_ = 0;  ///< points read in all; points swept by this process
  std::uint64_t recalled_slabs_before_ = 0;           ///< number of slabs that recalls of earlier processes have read
  bool half_way_noted_;
  double active_sum_ = 0;
};

}  // namespace pointsweep
