// SPDX-License-Identifier: MIT
/// All finite points of a cloud in memory, and a tree of boxes, written for the check, that finds their neighbours, for
/// graphs over the whole cloud.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "pointsweep/verify/values/cloud_formula.h"

namespace pointsweep {

/// A tree over the different positions ("places") of points, which ascend by x, y, z. A place may have several points.
class PlaceTree {
 public:
  using Place = std::array<double, 3>;
  struct Near {
    double distance2;  ///< ((dx² + dy²) + dz²) in float64
    std::uint32_t place;

    friend bool operator<(const Near& a, const Near& b) {
      return a.distance2 != b.distance2 ? a.distance2 < b.distance2 : a.place < b.place;
    }
  };

  /// Builds the tree of `places`, with the number of points at each place in `points_at`. Borrows both.
  PlaceTree(std::span<const Place> places, std::span<const std::uint32_t> points_at);

  /// Returns the nearest places within the squared distance reach2, `place` first, until they hold `most` points
  /// together, or all if they hold fewer. Equal distances are ordered by x, y, z.
  std::vector<Near> nearest(std::uint32_t place, std::size_t most, double reach2) const;
  /// Calls `use` for all places within the squared distance reach2, including `place`, in any order.
  void within(std::uint32_t place, double reach2, const std::function<void(const Near&)>& use) const;

 private:
  struct Box {
    Place low, high;
    std::uint32_t begin, end;  ///< range of the box's places in `order_`
    std::uint32_t children;    ///< index of the first of two children; 0 for a leaf
  };
  void build(std::uint32_t box);
  double distance2_to(const Box& box, const Place& p) const;
  template <class Visit>
  void descend(std::uint32_t box, const Place& p, const double& reach2, const Visit& visit) const;

  std::span<const Place> places_;
  std::span<const std::uint32_t> points_at_;
  std::vector<std::uint32_t> order_;
  std::vector<Box> boxes_;
};

/// A cloud sorted in memory. Points are numbered by x, y, z, then row, so that points at one place follow one another.
class SortedCloud {
 public:
  static constexpr std::uint32_t kNone = 0xffffffff;

  /// Sorts the points of `in` and stores their values of `columns`. Throws NeedsMemory if the cloud, with `more_bytes`
  /// of additional memory for each point, does not fit in memory, NotTold for 2^32 - 1 or more points.
  SortedCloud(const CloudInput& in, std::span<const ColumnSource> columns, std::uint64_t more_bytes);

  std::uint32_t size() const { return static_cast<std::uint32_t>(place_of_.size()); }
  std::uint32_t places() const { return static_cast<std::uint32_t>(places_.size()); }
  std::uint32_t place_of(std::uint32_t point) const { return place_of_[point]; }
  std::uint32_t points_at(std::uint32_t place) const { return points_at_[place]; }
  Vec3 position(std::uint32_t point) const {
    const auto& p = places_[place_of_[point]];
    return {p[0], p[1], p[2]};
  }
  const double* values(std::uint32_t point) const { return values_.data() + std::size_t{point} * components_; }
  const PlaceTree& tree() const { return *tree_; }
  std::uint64_t row_of(std::uint32_t point) const { return row_of_[point]; }
  /// Returns the number of the point in a row of the input; kNone if it has non-finite coordinates.
  std::uint32_t point_of(std::uint64_t row) const { return point_of_row_[row]; }

  /// Calls use(i, j, squared distance) for each neighbour j of each point i; i ascends.
  void for_each_neighbor(const NeighborRule& rule,
                         const std::function<void(std::uint32_t i, std::uint32_t j, double distance2)>& use) const;

 private:
  std::vector<PlaceTree::Place> places_;
  std::vector<std::uint32_t> points_at_, first_at_, place_of_, point_of_row_, row_of_;
  std::size_t components_ = 0;
  std::vector<double> values_;
  std::unique_ptr<PlaceTree> tree_;
};

}  // namespace pointsweep
