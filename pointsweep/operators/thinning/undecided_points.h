// SPDX-License-Identifier: MIT
/// A greedy choice of points by priority, made while the points come in the order of a coordinate.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <unordered_map>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/in_order_operator.h"

namespace pointsweep {

/// Seed of the hashes of coordinates that give the order in which points are decided.
inline constexpr std::uint64_t kPoissonSeed = 0x706f6973736f6e;  // "poisson" in ASCII

/// A point of the choice. The lesser of two points is decided first.
struct DiskPoint {
  Vec3 position;
  std::uint64_t hash = 0;
  std::uint64_t row = 0;
  double radius2 = 0;  ///< squared radius

  bool operator<(const DiskPoint& other) const;
};

/// The greedy choice: in ascending order of DiskPoint, a point is kept unless a kept point lies within its radius.
/// Points come in the order of a coordinate instead, and every order of evaluation gives the same set (Blelloch,
/// Fineman and Shun, Greedy sequential maximal independent set and matching are parallel on average, SPAA 2012):
/// - A point is complete when the front, the coordinate of the newest point along the axis, is farther ahead of it than
///   the largest radius: all points that may affect it have come.
/// - A complete point waits for any lesser undecided point within its radius. If there is no such point, the complete
///   point is kept, and all points that have it within their own radius are dropped, complete or not. The kept point
///   then affects no later point, and is removed.
/// - A part of a cloud may lack points of other parts. A complete point that no kept point excludes, and for which
///   lesser points may be missing, then stays undecided, and so do the points that only this point would exclude.
/// So memory holds the points that are not complete, and the complete points that wait for incomplete points. Chains of
/// waiting points are short, about the logarithm of the number of points.
class UndecidedPoints {
 public:
  /// `axis`: axis along which points ascend. `most`: number of points that may be held at once.
  UndecidedPoints(int axis, double largest_radius, std::uint64_t most);

  /// Adds a point, which must not precede the last point along the axis. Its radius is at most the largest radius.
  /// `lacks_some`: true if lesser points within its radius may never come. Throws Error if the limit is exceeded.
  void hold(const DiskPoint& point, bool lacks_some = false);
  /// Decides the points that can be decided, if enough points have come since the last decisions. Appends the dropped
  /// rows, and the rows that depend on missing points.
  void decide(Findings& findings);
  /// Decides the remaining points; called after the last point.
  void finish(Findings& findings);
  std::uint64_t held() const { return slots_.size() - free_.size(); }

  /// Bytes of memory for each point held, including containers that grow in steps.
  static constexpr std::uint64_t kPointBytes = 192;

 private:
  using Slot = std::uint32_t;
  static constexpr Slot kNone = std::numeric_limits<Slot>::max();
  /// A point that is held. Two lists hold its slot: its cell, until the cell forgets its decided points, and the list
  /// of its state:
  /// - incomplete (incomplete_) until the front is far enough ahead;
  /// - to be decided (to_decide_): the point waits if an undecided lesser point lies within its radius, else it is kept
  ///   or left undecided;
  /// - waiting (the waiters of that lesser point), until the lesser point is decided: if it is kept, it has dropped the
  ///   waiting point; otherwise the waiting point is to be decided again.
  /// A kept point may drop points in each of these states; a dropped point stays in its lists until they are processed.
  struct Held {
    DiskPoint point;
    Slot first_waiter = kNone;  ///< first of the points that wait for this point
    Slot next_waiter = kNone;   ///< next of the points that wait for the point for which this point waits
    bool is_decided = false;
    bool lacks_some = false;  ///< true if a lesser point within the radius may be missing or stays undecided
    std::uint8_t uses = 0;    ///< number of lists that hold the slot
  };
  struct Member {
    std::uint64_t hash;
    Slot slot;
  };
  /// The points of a cell. The first `sorted` members ascend; newer members follow. Some may be decided.
  struct Cell {
    std::vector<Member> members;
    std::size_t sorted = 0, decided = 0;
  };
  using CellKey = std::array<std::int64_t, 3>;
  struct CellHash {
    std::size_t operator()(const CellKey& key) const;
  };

  std::int64_t cell_along(double c) const;
  template <class Visit>
  void visit_cells_around(Vec3 p, Visit visit);
  bool precedes(const Member& a, const Member& b) const;
  void sort(Cell& cell) const;
  Slot place(const DiskPoint& point);
  void take_complete(double front);
  void decide_waiting(Findings& findings);
  Slot lesser_within(const DiskPoint& point);
  template <class Use>
  void decide_for_greater(Slot slot, Use use);
  void keep(Slot slot, Findings& findings);
  void leave_out(Slot slot, Findings& findings);
  void leave_open(Slot slot, Findings& findings);
  void let_waiters_decide(Slot slot);
  void forget_decided(Cell& cell);
  void release(Slot slot);

  int axis_;
  double radius_, cell_;  ///< largest radius; edge length of a cell, which is not less
  std::uint64_t most_;
  double front_;
  std::uint64_t come_ = 0;  ///< points since the last decisions of decide()
  std::deque<Held> slots_;
  std::vector<Slot> free_;
  std::unordered_map<CellKey, Cell, CellHash> cells_;
  std::deque<Slot> incomplete_;  ///< points that are not complete, in order of arrival; some may be dropped already
  std::vector<Slot> to_decide_;  ///< complete points that wait for no known point
};

}  // namespace pointsweep
