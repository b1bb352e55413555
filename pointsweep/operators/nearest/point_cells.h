// SPDX-License-Identifier: MIT
/// Searches in a set of points that does not fit in memory: compact cells of points are in temporary storage (Scratch),
/// and the cells near the current places are in memory, too.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <span>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/operators/nearest/searched_points.h"
#include "pointsweep/points/scratch.h"

namespace pointsweep {

class NearestBound;

class PointCells {
 public:
  /// The coordinates used in distances; `plane` ignores z.
  enum class Space : std::uint8_t { plane, all };

  /// `axis`: axis along which points come. `memory_bytes`: limit for the cells in memory; 128 cells may exceed it
  /// (least_bytes()).
  PointCells(Space space, int axis, std::uint64_t memory_bytes, std::unique_ptr<Scratch> scratch);
  PointCells(PointCells&&) noexcept;
  ~PointCells();
  /// Adds a point. Points come in ascending order along the axis, all of them before the first search.
  void add(Vec3 position, std::uint64_t row);
  void add(std::span<const Vec3> positions, std::span<const std::uint64_t> rows) {
    for (std::size_t i = 0; i < rows.size(); ++i) add(positions[i], rows[i]);
  }
  /// Ends the set. Must be called after the last point and before the first search.
  void finish();

  /// The object that answers searches with the cells in memory.
  class View;
  /// A function that answers question i, or returns false if cells are missing. PointCells calls the function again
  /// when these cells are in memory.
  using Answer = std::function<bool(std::size_t i, View& view)>;
  /// Answers n questions on all threads; each thread takes `at_once` questions at a time. Answers them one after
  /// another if the cells do not fit in memory. `place(i)`: place of question i. Successive places should be near each
  /// other.
  void answer_all(std::size_t n, std::size_t at_once, const std::function<Vec3(std::size_t i)>& place,
                  const Answer& answer);
  /// Calls `use`, on all threads, with the nearest points of each place, nearest first. The function may be called more
  /// than once for a place; each call replaces the answer of the call before.
  void nearest_of_all(std::span<const Vec3> places, const NearestWanted& wanted,
                      const std::function<void(std::size_t i, const std::vector<CellNeighbor>& found)>& use);

  /// All points of the set within a distance of some places, for nearest_within().
  struct WithinPlaces {
    std::vector<std::size_t> places;      ///< numbers of the places
    std::vector<std::size_t> counts;      ///< number of points of each place
    std::vector<CellNeighbor> neighbors;  ///< points of the first place, then of the second, and so on, nearest first
  };
  /// Finds all points whose squared distance from a place is at most radius * radius. Calls `use`, on all threads, with
  /// the points of a few places at a time; each place occurs once. Memory holds the points of only a few places per
  /// thread.
  void nearest_within(std::span<const Vec3> places, double radius, const std::function<void(WithinPlaces)>& use);

  /// Returns the least memory with which cells are not read again and again.
  static std::uint64_t least_bytes();

 private:
  class Tree;
  struct Cell {
    std::uint64_t first;  ///< number of points before the cell in scratch
    std::size_t count;
    std::unique_ptr<const Tree> loaded;
  };
  /// Consecutive points along the axis, divided into cells.
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
  std::vector<CellPoint> slab_;  ///< points of the slab that is being filled
  std::uint64_t count_ = 0;
  std::set<std::size_t> loaded_;
};

class PointCells::View {
 public:
  /// Returns the nearest points of the set, valid until the next search. Null if a needed cell is not in memory.
  const std::vector<CellNeighbor>* nearest(Vec3 place, const NearestWanted& wanted);
  /// Returns the number of points that the last search visited.
  std::size_t seen() const { return nearest_.seen(); }
  /// Calls `use` for all points of the set in a box, unordered. Returns false if a needed cell is not in memory: then
  /// some points may be missing.
  bool within(const Box& box, const std::function<void(const CellPoint&)>& use);
  enum class Collected : std::uint8_t { all, too_many, lacks_cells };
  /// Appends to `to` the points that `bound` does not exclude, and stops when `to` has more than `most` points.
  /// `places`: the box of the query places for which `bound` was made.
  Collected collect(const Box& places, const NearestBound& bound, std::size_t most, std::vector<CellPoint>& to);

 private:
  friend class PointCells;
  explicit View(const PointCells& of) : of_(of) {}
  const Tree* tree(std::size_t cell);
  /// Returns all slabs that overlap a range along the axis; the last slab may be among them although it ends before.
  std::span<const Slab> slabs_between(double lo, double hi) const;

  const PointCells& of_;
  std::vector<std::size_t> missing_;  ///< needed cells that were not in memory
  PointCells* loading_ = nullptr;  ///< set that loads needed cells at once; null: needed cells are recorded in missing_
  std::size_t near_ = 0;           ///< cell near the place; loading_ drops the cells farthest from this cell first
  NearestSoFar nearest_;
};

}  // namespace pointsweep
