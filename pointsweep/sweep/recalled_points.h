// SPDX-License-Identifier: MIT
/// Deferred points with their surroundings: everything their values depend on, and the neighbour lists of all of it.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <span>
#include <utility>
#include <vector>

#include "pointsweep/sweep/recall.h"
#include "pointsweep/sweep/region.h"

namespace pointsweep {

/// Level s holds the points whose values after step s are needed: the deferred points in the last level, in every other
/// one the level behind it and its neighbours. Lists are found from the last level to the first, values from the first
/// step to the last.
class RecalledPoints {
 public:
  RecalledPoints(const Stream& stream, const SweepPlan& plan, const SlabLoader& loader, const Frontier& frontier,
                 const RecallMemory& memory, std::vector<Worker>& workers)
      : plan_(plan),
        memory_(memory),
        workers_(workers),
        region_(stream, loader, frontier, memory.slabs_at_once),
        point_bytes_(window_point_bytes(plan)) {}

  /// Loads the surroundings of `points` and finds all lists. False if they take more memory than allowed; one point is
  /// always taken.
  bool gather(std::span<const DeferredPoint> points);
  /// Takes everything through the steps and hands the deferred points over.
  void finish(Sink& sink);

  std::uint64_t slabs_read() const { return region_.slabs_read(); }
  /// What it takes while the last lists are being found.
  std::uint64_t bytes() const { return region_.points() * point_bytes_ + list_bytes_ + pending_bytes_; }

 private:
  /// A point whose list is still to be found.
  struct Pending {
    std::uint32_t point;   ///< by index in the cell
    std::uint64_t points;  ///< if something is missing, the nearest cells that hold so many points are loaded next
  };
  /// Points of one cell that came into a level together. Lists for which there is no memory are found again when they
  /// are used; there are none here then.
  struct Listed {
    std::uint32_t level;
    std::vector<std::uint32_t> points;  ///< by index in the cell, ascending
    CellNeighbors lists;
    bool has_lists;
  };
  /// What is known of a cell of the region.
  struct CellState {
    std::vector<std::uint8_t> reached;  ///< by point: whether it is in a level, or is to come into the next one
    std::vector<double> leaf_reach;     ///< expected_reaches()
    std::vector<Pending> pending;       ///< ascending
    std::vector<Listed> listed;
    /// Of its deferred points, ascending: the point and the first step whose degenerate results count.
    std::vector<std::pair<std::uint32_t, std::uint32_t>> counted_from;
    NeededBalls needed;
  };

  std::uint32_t last_level() const { return static_cast<std::uint32_t>(plan_.step_count()) - 1; }
  std::uint64_t most_listed() const { return memory_.lists_bytes / sizeof(NeighborRef); }
  bool fits() const { return alone_ || bytes() <= memory_.bytes; }
  bool load_own_balls(std::span<const DeferredPoint> points);
  bool load_needed();
  bool load(std::span<const NeededBalls> balls, std::span<const NeededPlace> places);
  /// So many points are loaded around a point at first.
  std::uint64_t first_points() const { return std::uint64_t{plan_.neighborhood.k} + 1; }
  void place(std::span<const DeferredPoint> points);
  bool find_level(std::uint32_t level);
  void begin_level(std::uint32_t level);
  void need_expected(std::uint32_t slot, std::uint32_t level, Worker& worker);
  template <class Has>
  std::vector<std::uint32_t> cells_with(Has has) const;
  template <class Work>
  void for_cells(const std::vector<std::uint32_t>& slots, Work work);
  std::size_t search(std::uint32_t slot, std::span<const std::uint32_t> points, Worker& worker);
  void find_lists(std::uint32_t slot, std::uint32_t level, Worker& worker);
  std::vector<std::uint32_t> certify(std::uint32_t slot, std::span<const Pending> searched, Worker& worker);
  void truncate_found_lists(std::uint32_t slot, std::span<const std::uint32_t> points, Worker& worker);
  void keep(std::uint32_t slot, std::uint32_t level, std::vector<std::uint32_t> points, Worker& worker);
  void reach_neighbors(const CellNeighbors& lists);
  void take_step(std::uint32_t slot, std::uint32_t step, Worker& worker, Sink& sink);
  void apply_deferred(std::uint32_t slot, std::uint32_t step, std::span<const std::uint32_t> points,
                      const CellNeighbors& lists, Worker& worker, Sink& sink) const;
  void count_degenerate(std::uint32_t step, Worker& worker) const;
  void hand_over(std::uint32_t slot, std::span<const std::uint32_t> points, Worker& worker, Sink& sink) const;

  const SweepPlan& plan_;
  const RecallMemory& memory_;
  std::vector<Worker>& workers_;
  Region region_;
  std::uint64_t point_bytes_;
  bool alone_ = false;           ///< there is one deferred point
  std::deque<CellState> cells_;  ///< by slot
  std::atomic<std::uint64_t> list_bytes_ = 0, pending_bytes_ = 0;
};

}  // namespace pointsweep
