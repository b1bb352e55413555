// SPDX-License-Identifier: MIT
/// Deferred points with their surroundings: all points on which their values depend, with the neighbour lists of these
/// points.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <span>
#include <utility>
#include <vector>

#include "pointsweep/sweep/cell_lists.h"
#include "pointsweep/sweep/recall.h"
#include "pointsweep/sweep/region.h"
#include "pointsweep/sweep/slab_loader.h"
#include "pointsweep/sweep/window.h"

namespace pointsweep {

/// The deferred points and all points on which their values depend, in levels. Level s contains the points whose values
/// after step s are needed. The last level contains the deferred points; every other level contains the points of the
/// next level and their neighbours. Lists are found from the last level to the first, values from the first step to the
/// last.
///
/// A bound of the neighbourhood of each point is known before its list is found. The bound of a deferred point is the
/// reach that the sweep found, or a shorter one within which whole cells hold enough points. The bound of a neighbour q
/// of p is |q - p| + r, where r is the radius of the neighbourhood of p, because that ball holds p and all neighbours
/// of p; a search among the points in memory may give a shorter one. So the stream is read once for each level, to
/// collect all points that the searches of the level need.
class RecalledPoints {
 public:
  RecalledPoints(const Stream& stream, const SweepPlan& plan, const SlabLoader& loader, const Frontier& frontier,
                 const RecallMemory& memory, std::vector<Worker>& workers)
      : plan_(plan),
        frontier_(frontier),
        memory_(memory),
        workers_(workers),
        region_(stream, loader, frontier, memory.slabs_at_once),
        lists_(plan, region_, {memory.bytes, memory.lists_bytes}),
        point_bytes_(window_point_bytes(plan) + kStateBytes),
        record_bytes_(stream.record_schema().stride + sizeof(std::uint32_t)) {}

  /// Collects the surroundings of `points` and finds all lists. Returns false if points and lists take more memory than
  /// allowed; a single deferred point may take any amount.
  bool gather(std::span<const DeferredPoint> points);
  /// Takes the points of all levels through the steps and hands the deferred points over to `sink`. Returns the number
  /// of deferred points.
  std::size_t finish(Sink& sink);

  const SlabsRead& slabs_read() const { return region_.slabs_read(); }
  /// Returns the bytes of points and lists and, during collect(), of the balls.
  std::uint64_t bytes() const {
    return region_.points() * point_bytes_ + region_.slot_count() * sizeof(WindowCell) + list_bytes_ + pending_bytes_;
  }

 private:
  /// Points of one cell that came into a level together, with their lists if there is memory for them. Otherwise the
  /// lists are found again when they are used.
  struct Listed {
    std::uint32_t level;
    std::vector<std::uint32_t> points;  ///< indices of the points in the cell, ascending
    CellNeighbors lists;
    bool has_lists;
  };
  /// The state of a cell of the region.
  struct CellState {
    std::vector<std::uint8_t> reached;   ///< for each point, 0, kReachedNow or kInLevel
    std::vector<double> bound2;          ///< for each reached point, a squared distance that bounds its neighbourhood
    std::vector<std::uint32_t> pending;  ///< points whose lists are to be found, ascending
    std::vector<Listed> listed;
    /// The indices of the deferred points, ascending, each with the first step that it has not taken in the sweep.
    /// Degenerate results are counted from this step on; the sweep has counted earlier ones.
    std::vector<std::pair<std::uint32_t, std::uint32_t>> counted_from;
  };

  std::uint32_t last_level() const { return static_cast<std::uint32_t>(plan_.step_count()) - 1; }
  bool fits() const { return alone_ || bytes() <= memory_.bytes; }
  bool collect(WantedPoints wanted);
  bool collect_deferred(std::span<const DeferredPoint> points);
  bool may_hold_many(const Ball& ball, double widths) const;
  Ball smaller(const Ball& ball) const;
  void place(std::span<const DeferredPoint> points, std::span<const Ball> balls);
  void find_level(std::uint32_t level);
  bool begin_next_level();
  void bound_by_points_in_memory();
  void separate_large(WantedPoints& wanted) const;
  template <class Has>
  std::vector<std::uint32_t> cells_with(Has has) const;
  template <class Work>
  void for_cells(const std::vector<std::uint32_t>& slots, Work work);
  void find_lists(std::uint32_t slot, std::uint32_t level, Worker& worker);
  void expect_complete(std::uint32_t slot, const CellSubset& points, const CellNeighbors& lists) const;
  void keep(std::uint32_t slot, std::uint32_t level, const CellSubset& points, Worker& worker);
  void bound_neighbors(std::uint32_t slot, const CellSubset& points, const CellNeighbors& lists);
  void take_step(std::uint32_t slot, std::uint32_t step, Worker& worker, Sink& sink);
  void apply_deferred(std::uint32_t slot, std::uint32_t step, const CellSubset& points, const CellNeighbors& lists,
                      Worker& worker, Sink& sink) const;
  void count_degenerate(std::uint32_t step, Worker& worker) const;
  void hand_over(std::uint32_t slot, const CellSubset& points, Worker& worker, Sink& sink) const;

  const SweepPlan& plan_;
  const Frontier& frontier_;
  const RecallMemory& memory_;
  std::vector<Worker>& workers_;
  Region region_;
  const CellLists lists_;
  static constexpr std::uint64_t kStateBytes = sizeof(double) + 1;  ///< bytes of a point in CellState
  std::uint64_t point_bytes_;
  std::uint64_t record_bytes_;   ///< bytes of a record, and of an index in the slab, while points are collected
  bool alone_ = false;           ///< true for a single deferred point, which may take more memory than allowed
  std::deque<CellState> cells_;  ///< state of the cell in each slot
  std::atomic<std::uint64_t> list_bytes_ = 0;
  std::uint64_t pending_bytes_ = 0;
};

}  // namespace pointsweep
