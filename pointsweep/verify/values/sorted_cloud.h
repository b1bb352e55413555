// SPDX-License-Identifier: MIT
/// All finite points of a cloud in memory, with a search for neighbours, for graphs over the whole cloud.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "pointsweep/verify/formulas/place_tree.h"
#include "pointsweep/verify/values/cloud_formula.h"

namespace pointsweep {

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
  const formulas::PlaceTree& tree() const { return *tree_; }
  std::uint64_t row_of(std::uint32_t point) const { return row_of_[point]; }
  /// Returns the number of the point in a row of the input; kNone if it has non-finite coordinates.
  std::uint32_t point_of(std::uint64_t row) const { return point_of_row_[row]; }

  /// Calls use(i, j, squared distance) for each neighbour j of each point i; i ascends.
  void for_each_neighbor(const NeighborRule& rule,
                         const std::function<void(std::uint32_t i, std::uint32_t j, double distance2)>& use) const;

 private:
  std::vector<formulas::PlaceTree::Place> places_;
  std::vector<std::uint32_t> points_at_, first_at_, place_of_, point_of_row_, row_of_;
  std::size_t components_ = 0;
  std::vector<double> values_;
  std::unique_ptr<formulas::PlaceTree> tree_;
};

}  // namespace pointsweep
