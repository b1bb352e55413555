// SPDX-License-Identifier: MIT
/// The progress of a sweep between two turns: all that another process needs to continue the sweep (docs/adr/0008).
#pragma once

#include <cstdint>
#include <vector>

#include "pointsweep/order/packed.h"
#include "pointsweep/points/degenerate_rows.h"
#include "pointsweep/sweep/deferred_point.h"
#include "pointsweep/sweep/frontier.h"

namespace pointsweep {

/// A cell that is in the window, by its place: the slab is cut into the same cells again.
struct WindowedCell {
  std::uint32_t slab;
  std::uint32_t number;  ///< number of the cell in its slab
  std::uint32_t points;
  std::uint32_t finished;  ///< 1: its points have been handed over or deferred
  double reach;            ///< WindowCell::reach
};

struct DroppedCellOfSlab {
  std::uint64_t slab;
  DroppedCell cell;
};

struct SaturatedLocation {
  Vec3 place;
  std::uint64_t row;
};

struct SweepProgress {
  std::uint32_t slabs_read = 0;
  std::vector<WindowedCell> window;        ///< by slab and number; read cells that are not listed are finished
  std::vector<DroppedCellOfSlab> dropped;  ///< also once all slabs were read, for the recall
  std::vector<SaturatedLocation> saturated_locations;
  std::vector<DeferredPoint> deferred;  ///< points of finished cells that are not yet recalled
  /// Counts over finished cells and recalled points, with the meaning that they have in SweepStatistics.
  std::uint64_t certified = 0, recalled = 0, recalled_slabs = 0, peak_points = 0;
  std::vector<DegenerateRows> degenerate;  ///< by stage; may be shorter than the chain

  void pack(Packer& out) const;
  static SweepProgress unpacked(Unpacker& packed);
};

/// Keeps the progress of a sweep. Called by the thread of the sweep, while no points are handed to the sink.
class ProgressKeeper {
 public:
  virtual ~ProgressKeeper() = default;
  /// Asked after every turn and every batch of recalled points.
  virtual bool wants_progress() = 0;
  /// Keeps `progress`. The sink has received exactly the points that `progress` calls finished.
  virtual void keep(const SweepProgress& progress) = 0;
};

}  // namespace pointsweep
