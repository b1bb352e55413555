// SPDX-License-Identifier: MIT
/// Searches in a set of points that does not fit in memory: compact cells of it lie in scratch, and those near the
/// questions in memory.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <span>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/math/box.h"
#include "pointsweep/points/scratch.h"

namespace pointsweep {

struct CellPoint {
  Vec3 position;
  std::uint64_t row;
};

/// A point of the set, with its squared distance from the place that is asked about.
struct CellNeighbor {
  double distance2;  ///< in float64: (dx² + dy²) + dz², without dz² in the plane
  Vec3 position;
  std::uint64_t row;

  /// Nearest first; equal distances by x, y, z, row.
  bool operator<(const CellNeighbor& other) const;
};

/// Boxes of points that are halved again and again: part j of level l is one of 2^l parts of nearly the same size.
class HalvedBoxes {
 public:
  /// So many levels below the whole that no part of the last one has more than `most` points.
  static unsigned levels_for(std::size_t points, std::size_t most);
  /// Puts `points` in the order of the parts: each is halved across its widest extent.
  HalvedBoxes(std::span<CellPoint> points, unsigned levels, bool in_plane);

  unsigned levels() const { return levels_; }
  /// The first point of part j of the last level; of the part behind the last one: their number.
  std::size_t begin(std::size_t j) const { return part_begin(levels_, j); }
  /// Calls `use(j)` for parts of the last level that are not farther than worst() when their turn comes, the nearer
  /// half first. Ends and returns false when `use` does.
  template <class Worst, class Use>
  bool nearest_first(Vec3 place, Worst worst, Use use) const {
    return descend(0, 0, distance2(box(0, 0), place), place, worst, use);
  }
  /// The same for all parts that meet a box.
  template <class Use>
  bool all_within(const Box& wanted, Use use, unsigned level = 0, std::size_t j = 0) const {
    if (!meet(box(level, j), wanted)) return true;
    if (level == levels_) return use(j);
    return all_within(wanted, use, level + 1, 2 * j) && all_within(wanted, use, level + 1, 2 * j + 1);
  }

 private:
  std::size_t part_begin(unsigned level, std::size_t j) const { return points_ * j >> level; }
  const Box& box(unsigned level, std::size_t j) const { return boxes_[(std::size_t{1} << level) - 1 + j]; }
  static bool meet(const Box& a, const Box& b);
  template <class Worst, class Use>
  bool descend(unsigned level, std::size_t j, double d2, Vec3 place, Worst worst, Use use) const {
    if (d2 > worst()) return true;
    if (level == levels_) return use(j);
    const double first = distance2(box(level + 1, 2 * j), place), second = distance2(box(level + 1, 2 * j + 1), place);
    const std::size_t nearer = second < first;
    return descend(level + 1, 2 * j + nearer, std::min(first, second), place, worst, use) &&
           descend(level + 1, 2 * j + 1 - nearer, std::max(first, second), place, worst, use);
  }

  std::size_t points_;
  unsigned levels_;
  std::vector<Box> boxes_;
};

class PointCells {
 public:
  /// Whether distances have a third coordinate.
  enum class Space : std::uint8_t { plane, all };

  /// `axis`: along which points come; `memory_bytes`: for the cells that are in memory, of which there are a few in any
  /// case.
  PointCells(Space space, int axis, std::uint64_t memory_bytes, std::unique_ptr<Scratch> scratch);
  PointCells(PointCells&&) noexcept;
  ~PointCells();
  /// Points come in ascending order along the axis, all of them before the first question.
  void add(Vec3 position, std::uint64_t row);
  void finish();

  /// What a question is asked of. It sees the cells that are in memory.
  class View;
  /// Answers question i; false if a search lacked a cell. Then it is asked again, when more cells are in memory.
  using Answer = std::function<bool(std::size_t i, View& view)>;
  /// Answers n questions on all threads. `place(i)`: where question i is asked. Places that follow one another should
  /// be near to each other.
  void answer_all(std::size_t n, const std::function<Vec3(std::size_t i)>& place, const Answer& answer);

  /// The least memory that answers questions without reading most cells again and again.
  static std::uint64_t least_bytes();

 private:
  class Tree;
  struct Cell {
    std::uint64_t first;  ///< points before it in scratch
    std::size_t count;
    std::unique_ptr<const Tree> loaded;
  };
  /// Consecutive points along the axis.
  struct Slab {
    Box box;
    std::size_t first_cell;
    HalvedBoxes cells;
  };

  Vec3 flat(Vec3 p) const { return space_ == Space::plane ? Vec3{p.x, p.y, 0} : p; }
  void end_slab();
  std::size_t slab_at(double along) const;
  const Tree& load(std::size_t cell, std::size_t near);

  Space space_;
  int axis_;
  std::size_t most_loaded_;
  std::unique_ptr<Scratch> scratch_;
  std::vector<Cell> cells_;
  std::vector<Slab> slabs_;
  std::vector<CellPoint> slab_;  ///< that grows
  std::uint64_t count_ = 0;
  std::set<std::size_t> loaded_;
};

class PointCells::View {
 public:
  /// The k nearest of the set whose squared distance is at most `most2`, nearest first, until the next search. Null if
  /// a cell is needed that is not in memory.
  const std::vector<CellNeighbor>* nearest(Vec3 place, std::size_t k, double most2);
  /// Calls `use` for all points of the set in a box, in no particular order. False as above: then some may be missing.
  bool within(const Box& box, const std::function<void(const CellPoint&)>& use);

 private:
  friend class PointCells;
  explicit View(const PointCells& of) : of_(of) {}
  const Tree* tree(std::size_t cell);

  const PointCells& of_;
  std::size_t missing_ = 0;        ///< the cell that was needed
  PointCells* loading_ = nullptr;  ///< loads cells when they are needed,
  std::size_t near_ = 0;           ///< and drops first those far from this one
  std::vector<CellNeighbor> neighbors_;
};

}  // namespace pointsweep
