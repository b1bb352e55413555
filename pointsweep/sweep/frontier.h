// SPDX-License-Identifier: MIT
/// Boxes of the points that are not in memory: of slabs that the sweep has not read yet, and of cells that have left
/// the window (window.h). A ball that touches none of these boxes contains only points in memory and superfluous points
/// (see Frontier). The paper considers only unread points (Section 4.2.2).
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "pointsweep/math/box.h"
#include "pointsweep/math/box_tree.h"
#include "pointsweep/order/stream.h"

namespace pointsweep {

/// A cell that has left the window.
struct DroppedCell {
  Box box;
  std::uint32_t number;  ///< number of the cell in its slab
  std::uint32_t points;
};

/// The boxes of the unread slabs and of the cells that have left the window. Only the thread of the sweep
/// changes the frontier; queries are thread-safe.
///
/// Among coincident points, only the k + 1 points with the lowest rows belong to any neighbourhood. A location is
/// saturated once a cell has been read that holds more than k points, all at this location. A point at the location is
/// superfluous if its row is higher than the rows of k + 1 points of this cell. Slabs and cells of superfluous points
/// need not be read or kept, so a cloud may have more copies of a point than fit in memory.
class Frontier {
 public:
  /// Borrows `slabs`, of which the sweep reads the first `swept_slabs`. Slabs may come in any order; queries are fast
  /// if slabs mostly ascend along the axis.
  Frontier(const std::vector<Slab>& slabs, int axis, std::size_t swept_slabs);
  Frontier(const std::vector<Slab>& slabs, int axis) : Frontier(slabs, axis, slabs.size()) {}

  std::size_t slabs_read() const { return read_; }
  void slab_was_read() { ++read_; }
  /// Sets the number of slabs that have been read, for a sweep that continues an earlier sweep.
  void slabs_were_read(std::size_t first) { read_ = first; }
  /// Returns whether the sweep has slabs to read. Slabs that only the recall (recall.h) reads do not count.
  bool more_to_read() const { return read_ < swept_slabs_; }
  /// Treats each unread slab that is not superfluous as one cell that has left the window. All slabs then count as
  /// read. Must be called after the last slab of the sweep.
  void leave_unread_slabs();
  void cell_was_dropped(std::uint32_t slab, const DroppedCell& cell);
  /// Records that points at `place` with a row above `row` are superfluous.
  void location_is_saturated(Vec3 place, std::uint64_t row);

  /// Returns whether all points in a box are superfluous, if none of them has a row below `least_row`.
  bool is_superfluous(const Box& box, std::uint64_t least_row) const;
  /// Returns whether an unread slab that is not superfluous lies within sqrt(reach2) of a box. Returns false once all
  /// slabs are read, even for an infinite reach.
  bool unread_within(const Box& box, double reach2) const { return unread_within(box, reach2, true); }
  bool unread_within(Vec3 p, double reach2) const { return unread_within(Box{p, p}, reach2); }
  /// Like unread_within(), but considers only slabs that the sweep has still to read.
  bool still_read_within(const Box& box, double reach2) const { return still_read_within(box, reach2, true); }
  bool still_read_within(Vec3 p, double reach2) const { return still_read_within(Box{p, p}, reach2); }
  /// Like unread_within(), but considers only slabs that only the recall reads.
  bool only_recalled_within(const Box& box, double reach2) const { return only_recalled_within(box, reach2, true); }
  bool only_recalled_within(Vec3 p, double reach2) const { return only_recalled_within(Box{p, p}, reach2); }
  /// Returns whether any unread slab, superfluous or not, lies within sqrt(reach2) of a box.
  bool anything_unread_within(const Box& box, double reach2) const { return unread_within(box, reach2, false); }
  /// Returns the cells of a slab that have left the window, except superfluous cells, in any order.
  const std::vector<DroppedCell>& dropped_of(std::uint32_t slab) const { return dropped_[slab]; }
  /// Calls use(place, row) for each saturated location: points at `place` with a row above `row` are superfluous.
  template <class Use>
  void for_each_saturated_location(Use use) const {
    for (const auto& [at, row] : saturated_locations_) use(Vec3{at[0], at[1], at[2]}, row);
  }
  /// Fills `out` with the boxes of the dropped cells that lie within sqrt(reach2) of `box`.
  void dropped_near(const Box& box, double reach2, std::vector<Box>& out) const;

 private:
  bool unread_within(const Box& box, double reach2, bool needed_only) const {
    return still_read_within(box, reach2, needed_only) || only_recalled_within(box, reach2, needed_only);
  }
  bool still_read_within(const Box& box, double reach2, bool needed_only) const;
  bool only_recalled_within(const Box& box, double reach2, bool needed_only) const;
  bool counts(const Slab& slab, bool needed_only) const {
    return !needed_only || !is_superfluous(slab.box, slab.least_row);
  }

  const std::vector<Slab>& slabs_;
  int axis_;
  std::size_t swept_slabs_;
  /// For each slab that the sweep reads, the least coordinate along the axis of this slab and all later slabs.
  std::vector<double> least_begin_;
  BoxTree beyond_;  ///< the boxes of the slabs that only the recall reads
  std::size_t read_ = 0;
  std::vector<std::uint32_t> dropping_slabs_;      ///< numbers of the slabs with dropped cells
  std::vector<std::vector<DroppedCell>> dropped_;  ///< dropped cells of each slab
  std::map<std::array<double, 3>, std::uint64_t> saturated_locations_;
};

}  // namespace pointsweep
