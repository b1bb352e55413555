// SPDX-License-Identifier: MIT
/// Finishes the points that the sweep deferred: what they need has left the window and is read and evaluated again.
///
/// The paper has no such thing: its neighbourhoods are approximate there (Section 8). A recall works on a batch of
/// points: it reads the slabs that their balls touch, each once per level of the chain, finds the exact neighbourhoods,
/// and evaluates the stages on the points and, where stages look at made attributes, on their neighbours, by the same
/// code as the sweep.
#pragma once

#include <cstdint>
#include <vector>

#include "pointsweep/sweep/cell_runner.h"
#include "pointsweep/sweep/slab_loader.h"

namespace pointsweep {

class Recall {
 public:
  Recall(const Stream& stream, const SweepPlan& plan, const SlabLoader& loader)
      : stream_(stream), plan_(plan), loader_(loader) {}

  /// Finishes `points` and hands them to `sink`. Uses all threads; memory is proportional to points × (k + 1)^steps.
  void run(std::vector<DeferredPoint> points, Sink& sink, StageTally& tally);
  /// How many points a batch may hold for that memory to stay below `bytes`.
  std::size_t batch_points(std::size_t bytes) const;
  std::uint64_t slabs_read() const { return slabs_read_; }

 private:
  const Stream& stream_;
  const SweepPlan& plan_;
  const SlabLoader& loader_;
  std::uint64_t slabs_read_ = 0;
};

}  // namespace pointsweep
