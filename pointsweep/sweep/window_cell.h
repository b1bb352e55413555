// SPDX-License-Identifier: MIT
/// A cell in the window, with all that is known of its points while they are active, and sets of such cells, as
/// searches and stages look at them.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/points/degenerate_points.h"
#include "pointsweep/search/cell.h"
#include "pointsweep/search/cell_search.h"
#include "pointsweep/search/directory.h"
#include "pointsweep/sweep/plan.h"

namespace pointsweep {

/// A point that the sweep could not finish: its neighbourhood touches something already dropped or not read in time.
struct DeferredPoint {
  Vec3 position;
  std::uint64_t row;
  std::uint32_t slab;
  std::uint32_t index_in_slab;
  double reach2;       ///< its neighbourhood ends within it; infinite if unknown
  std::uint32_t step;  ///< the first step it has not taken
};

struct WindowCell {
  Cell cell;
  std::uint32_t slab = 0;
  std::uint32_t number = 0;  ///< number of the cell in its slab
  std::vector<std::uint32_t> index_in_slab;
  std::vector<std::vector<std::byte>> columns;    ///< by column number; empty where not made
  std::vector<const std::byte*> column_pointers;  ///< pointers into `columns`, in the form that Neighborhoods takes

  std::uint32_t steps_done = 0;
  std::vector<double> leaf_reach;        ///< how far the neighbourhoods of each leaf should reach; until searched
  double wait_reach = 0;                 ///< the search waits until nothing unread is as near as this
  std::size_t wait_for_slabs = 0;        ///< and until so many slabs have been read
  double reach = 0;                      ///< how far most of its neighbourhoods reached, once searched
  std::vector<CellNeighbors> lists;      ///< kept if a later step needs them and there is room: of runs of its points
  std::vector<std::uint32_t> refers_to;  ///< slots of the cells its lists name
  /// Points that could not be finished in the sweep, which are left to the recall; empty if there are none. While
  /// cells are worked on in parallel a cell marks its own in `deferred`; others look at `deferred_before`, as it was
  /// before the step.
  std::vector<std::uint8_t> deferred, deferred_before;
  /// Counts and points that the cell adds to the counts and the deferred points of the run when it is finished.
  std::uint64_t certified = 0;
  std::vector<DegeneratePoints> degenerate;  ///< by stage; empty if there are none
  std::vector<DeferredPoint> left_to_recall;
  /// It was finished before the run was resumed, or belongs to a halo: nothing of it is handed over.
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

/// At most one in this many points of a cell is deferred for unread slabs. With more such points, the cell waits and is
/// searched again. A deferred point costs several times as much as a point that is searched twice.
inline constexpr std::size_t kStragglers = 8;

/// Bytes of a point in the window without columns and lists: coordinates, row and place in the slab.
inline constexpr std::uint64_t kOwnPointBytes =
    3 * sizeof(double) + sizeof(std::uint64_t) + sizeof(decltype(WindowCell::index_in_slab)::value_type);
/// Bytes of a leaf in the window: its box, lowest row and reach.
inline constexpr std::uint64_t kWindowLeafBytes = 6 * sizeof(float) + sizeof(std::uint64_t) + sizeof(double);
/// Points in each half of a cell that has one point too many and is cut in two. A smaller cell holds a whole slab.
inline constexpr std::uint64_t kUsualCellPoints = 512;
/// Padding of whole leaves, and what is lost between allocations: a fifth of the rest.
inline constexpr std::uint64_t kLostShare = 5;

/// Returns the bytes that a point takes in the window, with its columns and without its lists. The memory plan, the
/// limit on kept lists and the recall all use this number.
inline std::uint64_t window_point_bytes(const SweepPlan& plan) {
  constexpr std::uint64_t kShared = kWindowLeafBytes / kLeafCapacity + 1 + sizeof(WindowCell) / kUsualCellPoints + 1;
  constexpr std::uint64_t kBytes = kOwnPointBytes + kShared;
  return kBytes + kBytes / kLostShare + plan.cell_lifetime_bytes();
}

/// Cells by slot. The window of a sweep and the region of a recall are such sets, so that the same functions search
/// their cells and take them through the steps. Reading is thread-safe, changing is not.
class CellSet {
 public:
  WindowCell& at(std::uint32_t slot) { return *cells_[slot]; }
  const WindowCell& at(std::uint32_t slot) const { return *cells_[slot]; }
  const CellDirectory& directory() const { return directory_; }
  const PointColumns* slots() const { return views_.data(); }  ///< by slot
  const std::vector<std::uint32_t>& occupied() const { return directory_.slots(); }
  std::uint32_t slot_count() const { return static_cast<std::uint32_t>(cells_.size()); }  ///< occupied or not
  std::uint64_t points() const { return points_; }

 protected:
  CellSet() = default;
  ~CellSet() = default;
  /// Puts the cell into a slot that a removed cell has left, or into the next new one.
  void add(std::unique_ptr<WindowCell> cell);
  void remove(std::uint32_t slot);

 private:
  std::uint32_t free_slot();

  std::vector<std::unique_ptr<WindowCell>> cells_;  ///< by slot
  std::vector<PointColumns> views_;                 ///< by slot
  std::vector<std::uint32_t> free_;
  CellDirectory directory_;
  std::uint64_t points_ = 0;
};

}  // namespace pointsweep
