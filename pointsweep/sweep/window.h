// SPDX-License-Identifier: MIT
/// The window: the cells now in memory (the paper's active working set A), each with the data of its points, and sets
/// of cells for searches and stages.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/points/degenerate_points.h"
#include "pointsweep/search/best_list.h"
#include "pointsweep/search/cell.h"
#include "pointsweep/search/cell_search.h"
#include "pointsweep/sweep/frontier.h"
#include "pointsweep/sweep/plan.h"

namespace pointsweep {

/// A point that the sweep could not finish, so that the recall (recall.h) finishes it: its neighbourhood touches a
/// dropped cell or a slab that was not read in time, or contains a deferred point whose values a later step needs.
struct DeferredPoint {
  Vec3 position;
  std::uint64_t row;
  std::uint32_t slab;
  std::uint32_t index_in_slab;
  double reach2;       ///< squared distance within which the neighbourhood of the point ends; infinite if unknown
  std::uint32_t step;  ///< first step that the point has not taken
};

struct WindowCell {
  Cell cell;
  std::uint32_t slab = 0;
  std::uint32_t number = 0;  ///< number of the cell in its slab
  std::vector<std::uint32_t> index_in_slab;
  std::vector<std::vector<std::byte>> columns;    ///< values by number of column; empty if not made
  std::vector<const std::byte*> column_pointers;  ///< pointers into `columns`, in the form that Neighborhoods takes

  std::uint32_t steps_done = 0;
  /// For each leaf, the expected reach of its points, until the last search; a search after which the cell waits raises
  /// it to the greatest finite reach found in the leaf. The reach of a point is the distance at which its neighbourhood
  /// ends.
  std::vector<double> leaf_reach;
  /// While slabs are left to read, the search waits until none is nearer than this (before the first search: times
  /// Window::allowance_).
  double wait_reach = 0;
  std::size_t wait_for_slabs = 0;  ///< while slabs are left to read, the search waits until this many are read
  /// Reach of about 9 in 10 points of the cell, at most its diagonal + wait_reach; known after the search.
  double reach = 0;
  std::vector<CellNeighbors> lists;      ///< lists of runs of points, if a later step needs them and memory allows
  std::vector<std::uint32_t> refers_to;  ///< slots of the cells that the lists name
  /// For each point, 1 if the sweep deferred the point to the recall; empty if no point was deferred. A cell marks its
  /// own points in `deferred` while cells are processed in parallel; other cells read `deferred_before`, the state
  /// before the step.
  std::vector<std::uint8_t> deferred, deferred_before;
  /// Number of certified points (points whose neighbourhoods are proven exact). When the cell is finished, this number
  /// and the next two members are added to the counts and the deferred points of the run.
  std::uint64_t certified = 0;
  std::vector<DegeneratePoints> degenerate;  ///< marked points of each stage; empty if no point is marked
  std::vector<DeferredPoint> left_to_recall;
  /// True if results of the cell are not delivered, because the cell was finished before the run was resumed or belongs
  /// to a halo (Slab::is_halo).
  bool is_only_looked_at = false;
  std::chrono::steady_clock::time_point read_at;

  PointColumns view() const { return {cell.x, cell.y, cell.z, cell.row, column_pointers.data()}; }
  bool is_deferred(std::uint32_t i) const { return !deferred.empty() && deferred[i] != 0; }
  bool was_deferred(std::uint32_t i) const { return !deferred_before.empty() && deferred_before[i] != 0; }
  void make_column(std::uint16_t column, std::size_t bytes_per_point) {
    columns[column].resize(bytes_per_point * cell.size());
    column_pointers[column] = columns[column].data();
  }
};

/// The reciprocal of the largest share of a cell's points that may be deferred because their neighbourhoods touch
/// unread slabs. With more such points, the cell waits and is searched again: a deferred point costs several times as
/// much as two searches of a point.
inline constexpr std::size_t kStragglers = 16;

/// Fills WindowCell::leaf_reach and wait_reach with estimates in units of the cloud. No result depends on these
/// estimates.
void expect_reaches(WindowCell& cell, const Neighborhood& what);

/// Bytes of a point in the window without columns and lists: coordinates, row and place in the slab.
inline constexpr std::uint64_t kOwnPointBytes =
    3 * sizeof(double) + sizeof(std::uint64_t) + sizeof(decltype(WindowCell::index_in_slab)::value_type);
/// Bytes of a leaf in the window: its box, lowest row and reach.
inline constexpr std::uint64_t kWindowLeafBytes = 6 * sizeof(float) + sizeof(std::uint64_t) + sizeof(double);
/// The number of points over which the fixed bytes of a cell are spread: half of a full cell. Cells may be smaller.
inline constexpr std::uint64_t kUsualCellPoints = 512;
/// The reciprocal of the share of memory for the padding of leaves and the overhead of allocations.
inline constexpr std::uint64_t kLostShare = 5;

/// Returns the bytes of a point in the window, with the columns that it has as long as it is in memory, and without its
/// list. The memory plan, the limit of stored lists and the recall use this number.
inline std::uint64_t window_point_bytes(const SweepPlan& plan) {
  constexpr std::uint64_t kShared = kWindowLeafBytes / kLeafCapacity + 1 + sizeof(WindowCell) / kUsualCellPoints + 1;
  constexpr std::uint64_t kBytes = kOwnPointBytes + kShared;
  return kBytes + kBytes / kLostShare + plan.cell_lifetime_bytes();
}

/// A set of cells, each in a numbered slot. The window of a sweep and the region of a recall are such sets, so that the
/// same functions search their cells and take them through the steps. Reading is thread-safe, changing is not.
class CellSet {
 public:
  WindowCell& at(std::uint32_t slot) { return *cells_[slot]; }
  const WindowCell& at(std::uint32_t slot) const { return *cells_[slot]; }
  const CellDirectory& directory() const { return directory_; }
  const PointColumns* slots() const { return views_.data(); }  ///< returns the points of the cell in each slot
  const std::vector<std::uint32_t>& occupied() const { return directory_.slots(); }
  /// Returns the number of slots, occupied or not.
  std::uint32_t slot_count() const { return static_cast<std::uint32_t>(cells_.size()); }
  std::uint64_t points() const { return points_; }

 protected:
  CellSet() = default;
  ~CellSet() = default;
  /// Puts the cell into a slot that a removed cell has left, or into a new slot.
  void add(std::unique_ptr<WindowCell> cell);
  void remove(std::uint32_t slot);

 private:
  std::uint32_t free_slot();

  std::vector<std::unique_ptr<WindowCell>> cells_;  ///< cell in each slot; null in a free slot
  std::vector<PointColumns> views_;                 ///< points of the cell in each slot
  std::vector<std::uint32_t> free_;
  CellDirectory directory_;
  std::uint64_t points_ = 0;
};

/// The cells that the sweep has read and still needs. Each cell leaves separately: a dense cell leaves early while a
/// sparse cell beside it stays, so that neither an outlier nor a scanner's far field keeps dense parts in memory. Only
/// the thread of the sweep changes the window.
class Window : public CellSet {
 public:
  Window(const SweepPlan& plan, Frontier& frontier) : plan_(plan), frontier_(frontier) {}

  void admit(std::unique_ptr<WindowCell> cell);
  /// Returns the slots of the cells that can take step `step` now, ascending.
  std::vector<std::uint32_t> ready_for(std::uint32_t step) const;
  /// Adapts the waiting time of later cells to `slots`, the cells just searched for the first step. If many of these
  /// cells must be searched again, as in noise, later cells wait longer before their first search.
  void note_searched(const std::vector<std::uint32_t>& slots);
  /// Drops every finished cell that no unfinished cell refers to and that later points are unlikely to need.
  void drop();

  double lifespan_sum() const {
    return lifespan_sum_;
  }  ///< sum of seconds × points over cells that have left the window
  double lifespan_max() const { return lifespan_max_; }

 private:
  bool ready(const WindowCell& cell, std::uint32_t step) const;
  void note_saturated_location(const WindowCell& cell);
  double kept_clear(double reach) const;
  bool asks_for(const WindowCell& waiting, const WindowCell& cell) const;
  bool still_needed(const WindowCell& cell, const std::vector<const WindowCell*>& unsearched) const;

  const SweepPlan& plan_;
  Frontier& frontier_;
  double allowance_ = 1;  ///< factor on the expected reaches of waiting cells (see note_searched())
  double lifespan_sum_ = 0, lifespan_max_ = 0;
};

}  // namespace pointsweep
