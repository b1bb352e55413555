// SPDX-License-Identifier: MIT
/// The engine: one pass of the sweep plane over the ordered stream (paper Section 5.3 and Figure 16). In each turn, the
/// sweep reads some slabs and takes all cells that are ready through the steps of the plan.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/connect/bucketed_graph.h"
#include "pointsweep/order/stream.h"
#include "pointsweep/points/degenerate_points.h"
#include "pointsweep/storage/encoding.h"
#include "pointsweep/sweep/frontier.h"
#include "pointsweep/sweep/plan.h"
#include "pointsweep/sweep/stage_runner.h"
#include "pointsweep/sweep/window.h"

namespace pointsweep {

/// The state of a point during a sweep.
enum class PointState : std::uint8_t {
  unread,
  waiting,   ///< the point is in the window and waits for unread slabs near it
  searched,  ///< the neighbourhood of the point is known; the point waits for values of its neighbours
  kept,      ///< the cell of the point is finished, but other points may need it
  gone,      ///< the point has left the window
};

/// A cell of the window in a stored progress. Slab and number identify a cell, since a slab is cut into equal cells
/// every time.
struct WindowedCell {
  std::uint32_t slab;
  std::uint32_t number;  ///< number of the cell in its slab
  std::uint32_t points;
  std::uint32_t finished;  ///< 1 if no point of the cell is left to deliver or defer, else 0
  double reach;            ///< WindowCell::reach
};

struct DroppedCellOfSlab {
  std::uint64_t slab;
  DroppedCell cell;
};

/// A location at which points with rows above `row` are superfluous (see Frontier).
struct SaturatedLocation {
  Vec3 place;
  std::uint64_t row;
};

/// The progress of a sweep between two turns: all data that another process needs to continue the sweep
/// (docs/adr/0008).
struct SweepProgress {
  std::uint32_t slabs_read = 0;
  std::vector<WindowedCell> window;  ///< cells of the window, in any order; other cells of the slabs read are finished
  std::vector<DroppedCellOfSlab> dropped;  ///< dropped cells; the recall needs them even if all slabs have been read
  std::vector<SaturatedLocation> saturated_locations;
  std::vector<DeferredPoint> deferred;  ///< points of finished cells that are not yet recalled
  /// Counts so far, with the meanings of the members of SweepStatistics; `certified` counts the points of finished
  /// cells and the recalled points.
  std::uint64_t certified = 0, recalled = 0, recalled_slabs = 0, peak_points = 0;
  /// For each stage, rows whose data define no result. Entries for the last stages may be missing.
  std::vector<DegenerateRows> degenerate;

  void encode(Encoder& out) const;
  static SweepProgress decode(Decoder& in);
};

/// Keeps the progress of a sweep. The thread of the sweep calls both functions, while no points are handed to the sink.
class ProgressKeeper {
 public:
  virtual ~ProgressKeeper() = default;
  /// Returns whether keep() is to be called now. Called after every turn and every group of recalled points, except
  /// while a resumed run reads slabs again.
  virtual bool wants_progress() = 0;
  /// Keeps `progress`. The sink has received exactly the points that `progress` calls finished.
  virtual void keep(const SweepProgress& progress) = 0;
};

struct SweepOptions {
  std::uint32_t cell_points = 1024;      ///< a multiple of 16, at most kCellCapacity
  std::size_t read_ahead = 1;            ///< slabs that are read and cut while earlier slabs are processed; at least 1
  std::uint32_t slabs_per_turn = 1;      ///< slabs that are read before the steps are taken; at least 1
  std::size_t recall_bytes = 64u << 20;  ///< bytes of memory for a group of recalled points
  std::uint64_t spare_bytes = 0;         ///< resident bytes up to which the recall leaves freed memory to the allocator
  /// Memory for the cells of the window. Cells may exceed this limit; lists for later steps use only the rest.
  std::uint64_t cells_bytes = std::numeric_limits<std::uint64_t>::max();
  /// Memory for the lists that each thread uses at a time. Cells with larger lists are processed in runs of points, at
  /// least one point each.
  std::uint64_t lists_bytes = 16u << 20;
  bool count_distances = false;  ///< true to fill SweepStatistics::distances
  /// If not null, receives the PointState of every input row when half of the points have been read. Its size must be
  /// the number of rows of the input, and all elements PointState::unread.
  std::vector<PointState>* half_way = nullptr;
  /// Receives the edges that a connecting stage emits. Edges are not part of a SweepProgress, so `keeper` must be null.
  EdgeSink* edges = nullptr;
  ProgressKeeper* keeper = nullptr;
  /// If not null, the sweep continues from this progress, which a keeper has received, perhaps in another process.
  /// Stream, plan and `cell_points` must equal those of the earlier sweep, and the sink must contain the results that
  /// the earlier sweep had delivered. `half_way` must be null.
  const SweepProgress* resume_from = nullptr;
  /// Called by the thread of the sweep, after each turn with the numbers of points read so far and of points in the
  /// window, and after each group of the recall with the number of points left as `points_active`. May throw to end the
  /// run.
  std::function<void(std::uint64_t points_read, std::uint64_t points_active)> progress;
};

struct SweepStatistics {
  /// Points whose neighbourhoods are proven exact; at the end all points of the swept slabs, except points of a halo
  /// (Slab::is_halo).
  std::uint64_t certified = 0;
  std::uint64_t recalled = 0;  ///< certified points that were finished in the recall
  std::uint64_t recalled_slabs = 0;
  std::uint64_t recalled_bytes = 0;        ///< bytes of the slabs that the recall of this process has read
  std::vector<DegenerateRows> degenerate;  ///< for each stage, rows whose data define no result
  double read_seconds = 0, search_seconds = 0, recall_seconds = 0;  ///< summed over threads; recall: wall time
  std::vector<double> stage_seconds;                                ///< for each stage, summed over threads
  std::uint64_t peak_points = 0;  ///< most points in the window after the steps of a turn, before cells are dropped
  double mean_points = 0;         ///< mean number of points in the window, over the turns of this process
  /// For each turn, the number of points read so far and the number of points in the window.
  std::vector<std::pair<std::uint64_t, std::uint64_t>> series;
  /// A series for each step, named after its operators: points read, and points in the window whose next step is this
  /// step. The last series counts the points of finished cells, before cells are dropped.
  std::vector<std::pair<std::string, std::vector<std::pair<std::uint64_t, std::uint64_t>>>> buffers;
  double lifespan_mean = 0, lifespan_max = 0;  ///< mean and most seconds of a point in the window
  NeighborDistances distances;                 ///< one count for each finite point with neighbours, if requested
};

/// Runs the plan over the swept slabs; hands each of their points, except points of a halo, to `sink` exactly once,
/// counting an earlier sweep that it continues. Uses thread_count() threads. The results do not depend on threads,
/// slabs, cells or memory. An exception ends the sweep and is thrown; but the sweep goes on after a RowError, and
/// throws the error of the lowest row at its end.
SweepStatistics sweep(const Stream& stream, const SweepPlan& plan, Sink& sink, const SweepOptions& options);

}  // namespace pointsweep
