// SPDX-License-Identifier: MIT
/// A tree of boxes, written for the check, that finds the neighbours of all points of a cloud in memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace pointsweep::formulas {

/// A tree over the different places of points, which ascend by x, y, z. A place may have several points.
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

}  // namespace pointsweep::formulas
