// SPDX-License-Identifier: MIT
/// Groups of places near each other, whose nearest points are found together, and the bound that excludes points that
/// are not among the nearest of any place in a box.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "pointsweep/math/box.h"
#include "pointsweep/operators/nearest/point_cells.h"
#include "pointsweep/operators/nearest/searched_points.h"

namespace pointsweep {

/// Excludes a point p if k points r are nearer than p to each place q of a box. One test decides for all places:
/// (q - p)² - (q - r)² is linear in q, so its least value over the places is at an end of the box in each coordinate
/// (Emrich, Kriegel, Kröger, Renz and Züfle, Boosting spatial pruning: on optimal pruning of MBRs, SIGMOD 2010). The
/// bound also excludes most points if the box is far away from them, where all points are almost equally far.
class NearestBound {
 public:
  /// `near`: a box that contains k points. Points whose squared distance from all places exceeds `most2` are excluded,
  /// too.
  NearestBound(const Box& places, const Box& near, double most2) : places_(places), most2_(most2 * (1 + kMargin)) {
    double sum = 0;
    for (int a = 0; a < 3; ++a) {
      at_lo_[a] = farthest2(near, places.lo[a], a), at_hi_[a] = farthest2(near, places.hi[a], a);
      sum += std::max(at_lo_[a], at_hi_[a]);
    }
    margin_ = sum * kMargin + kUnderflow;
    reach_ = std::sqrt(sum) * (1 + kMargin);
  }

  /// Returns the distance from the box of places along an axis beyond which no point is wanted.
  double reach() const { return reach_; }

  /// Returns whether all points in the box `points` are excluded.
  bool out(const Box& points) const {
    double least = 0, apart = 0;
    for (int a = 0; a < 3; ++a) {
      const double lo = gap(points, places_.lo[a], a), hi = gap(points, places_.hi[a], a);
      least += std::min(lo * lo - at_lo_[a], hi * hi - at_hi_[a]);
      const double between = std::max(0.0, std::max(points.lo[a] - places_.hi[a], places_.lo[a] - points.hi[a]));
      apart += between * between;
    }
    return least > margin_ || apart > most2_;
  }
  /// Returns whether a point is excluded. Does not test `most2`.
  bool out(Vec3 point) const {
    double least = 0;
    for (int a = 0; a < 3; ++a) {
      const double lo = point[a] - places_.lo[a], hi = point[a] - places_.hi[a];
      least += std::min(lo * lo - at_lo_[a], hi * hi - at_hi_[a]);
    }
    return least > margin_;
  }

 private:
  /// kMargin is relative to the squared distances. Rounding changes a squared distance by less than 2^-50 of its value.
  /// out() subtracts two squared distances, and a search later compares two. A wider margin would exclude fewer points
  /// if the places are far away from them.
  static constexpr double kMargin = 0x1p-46, kUnderflow = 1e-300;

  static double gap(const Box& box, double at, int a) {
    return std::max(0.0, std::max(box.lo[a] - at, at - box.hi[a]));
  }
  static double farthest2(const Box& box, double at, int a) {
    const double lo = at - box.lo[a], hi = at - box.hi[a];
    return std::max(lo * lo, hi * hi);
  }

  Box places_;
  Vec3 at_lo_, at_hi_;  ///< squared distances from the lower and upper end of the places to the farthest end of `near`
  double most2_, margin_ = 0, reach_ = 0;
};

/// A group of places whose nearest points are searched together. Places are searched one by one as long as the
/// searches visit few points on average. Far away from the points, or in the middle of a sphere of points, nearly all
/// points are as far as the nearest point. In these cases the points that may be among the nearest of any place are
/// collected from the cells; then the group is halved repeatedly, and each half keeps the points that may be among the
/// nearest of a place in that half. If too many points would be collected, the group is halved first, and each half is
/// answered in the same way.
class PlaceGroup {
 public:
  using Use = std::function<void(std::size_t i, const std::vector<CellNeighbor>& found)>;

  /// `places`: CellPoint::row is the number of a place for `use`. The group reorders the places.
  PlaceGroup(std::span<CellPoint> places, const NearestWanted& wanted, bool in_plane)
      : places_(places), wanted_(wanted), in_plane_(in_plane), done_(places.size()) {}

  Vec3 first() const { return places_.front().position; }
  /// Answers the searches whose cells are in memory. Returns false if cells are missing; the caller loads these cells
  /// and calls the function again.
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
