// SPDX-License-Identifier: MIT
/// Groups of places near each other, whose nearest points are found together.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "pointsweep/operators/nearest/cell_point.h"
#include "pointsweep/operators/nearest/halved_boxes.h"
#include "pointsweep/operators/nearest/point_cells.h"

namespace pointsweep {

/// A group of places whose nearest points are searched together. Places are searched one by one as long as each search
/// visits few points. Far away from the points, or in the middle of a sphere of points, nearly all points are as far as
/// the nearest. In these cases the points that may be among the nearest of any place are collected from the cells once,
/// the group is halved repeatedly, and each half keeps the points that may be among the nearest of a place in that
/// half. A group with too many such points is halved before the collection.
class PlaceGroup {
 public:
  using Use = std::function<void(std::size_t i, const std::vector<CellNeighbor>& found)>;

  /// `places`: CellPoint::row is the number of a place for `use`. The group reorders the places.
  PlaceGroup(std::span<CellPoint> places, const NearestWanted& wanted, bool in_plane)
      : places_(places), wanted_(wanted), in_plane_(in_plane), done_(places.size()) {}

  Vec3 first() const { return places_.front().position; }
  /// Answers the searches whose cells are in memory. Returns false if cells are missing; the caller loads them and
  /// calls again.
  bool answer(PointCells::View& view, const Use& use);

 private:
  struct Part {
    unsigned level;
    std::size_t j;
  };
  enum class Outcome { done, lacks_cells, takes_long };

  void search(Part part, PointCells::View& view, const Use& use);
  /// Searches the places of [begin, end) that are not done, until searches visit more than `most` points on average.
  Outcome one_by_one(std::size_t begin, std::size_t end, std::size_t most, PointCells::View& view, const Use& use);
  PointCells::View::Collected collect(const Box& places, PointCells::View& view);
  void narrow(Part part, std::size_t count, const Use& use);
  /// Stores the nearest of `points` in nearest_.
  void nearest_of(std::span<const CellPoint> points, Vec3 place, const NearestWanted& wanted);
  Vec3 flat(Vec3 p) const { return in_plane_ ? Vec3{p.x, p.y, 0} : p; }

  std::span<CellPoint> places_;
  NearestWanted wanted_;
  bool in_plane_;
  std::vector<bool> done_;           ///< true for places whose search is answered, in the order of places_
  std::optional<HalvedBoxes> tree_;  ///< tree of the places, if searching one by one takes long
  std::vector<Part> open_;           ///< parts whose searches need cells that are not in memory yet
  std::vector<CellPoint> points_;    ///< points that are collected for a part
  NearestSoFar nearest_;
};

}  // namespace pointsweep
