// SPDX-License-Identifier: MIT
/// Finishes the points that the sweep deferred because neighbours, or values of neighbours, were not in the window. To
/// this end, the recall reads these neighbours again.
///
/// The paper has no recall; its neighbourhoods are approximate in such places (Section 8). The recall takes the
/// deferred points in groups. It collects the points around a group in a region, finds the neighbourhoods of the
/// deferred points, of their neighbours, and so on, one level for each step of the chain, and takes all of these points
/// through the steps: by the search and the stages of the sweep, cell by cell, on all threads. For a group, each point
/// is evaluated at most once in each step, and each slab is read at most once for each step. A group that takes too
/// much memory is given up and tried again with half of its points.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "pointsweep/sweep/frontier.h"
#include "pointsweep/sweep/region.h"
#include "pointsweep/sweep/slab_loader.h"
#include "pointsweep/sweep/worker.h"

namespace pointsweep {

struct RecallMemory {
  /// Memory for points, columns and lists; the surroundings of a single point may take more.
  std::uint64_t bytes;
  std::uint64_t lists_bytes;      ///< memory for the lists that each thread uses at a time
  std::uint64_t spare_bytes = 0;  ///< size of the resident set above which freed memory is returned to the system
  std::size_t slabs_at_once = 1;  ///< number of slabs that may be read ahead; their memory comes in addition to `bytes`
};

class Recall {
 public:
  Recall(const Stream& stream, const SweepPlan& plan, const SlabLoader& loader, const Frontier& frontier,
         const RecallMemory& memory, std::vector<Worker>& workers)
      : stream_(stream), plan_(plan), loader_(loader), frontier_(frontier), memory_(memory), workers_(workers) {}

  /// Finishes the deferred points of all workers and passes them to `sink`, group by group in the order of slabs,
  /// within a slab in the order of rows. Calls done(points of the group, points left) after each group; the first
  /// worker then holds the points that are left.
  void run(Sink& sink, const std::function<void(std::size_t points, std::size_t left)>& done);
  const SlabsRead& slabs_read() const { return slabs_read_; }

 private:
  std::vector<DeferredPoint> take_deferred();
  std::size_t run_group(std::vector<DeferredPoint>& points, Sink& sink);
  std::size_t first_guess() const;

  const Stream& stream_;
  const SweepPlan& plan_;
  const SlabLoader& loader_;
  const Frontier& frontier_;
  RecallMemory memory_;
  std::vector<Worker>& workers_;
  std::size_t group_ = 0;  ///< number of points for the next group
  SlabsRead slabs_read_;
};

}  // namespace pointsweep
