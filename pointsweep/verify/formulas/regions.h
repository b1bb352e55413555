// SPDX-License-Identifier: MIT
/// The regions of the operator crop, evaluated from its definition.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace pointsweep::formulas {

using Corner = std::array<double, 2>;
/// The rings of a polygon, without the repeated first corner of each ring.
using PolygonRings = std::vector<std::vector<Corner>>;

/// Returns whether the first `bounds.size()` / 2 coordinates of p lie between the two corners of the box, or on its
/// faces.
bool is_in_box(const std::array<double, 3>& p, std::span<const double> bounds);

/// Polygons with an index of their edges along x.
class EdgesAlongX {
 public:
  explicit EdgesAlongX(std::span<const PolygonRings> polygons);

  /// Returns whether p lies in one of the polygons, by the even-odd rule, or on an edge. False if p is not finite.
  /// Exact unless magnitudes of coordinates differ by a factor of more than 2^400. Tests only edges whose extent along
  /// x contains the x of p.
  bool hold(const Corner& p) const;

 private:
  struct Edge {
    Corner left, right;
    std::uint32_t polygon;
  };
  void list(std::uint32_t edge, std::size_t node, std::size_t first, std::size_t last);

  /// A binary tree over stretches of the x axis: stretch 2 i is the coordinate ends_[i] of a corner, and stretch 2 i +
  /// 1 the interval up to the next corner. An edge is listed in the fewest nodes that make up its extent.
  std::vector<double> ends_;
  std::vector<Edge> edges_;
  std::vector<std::vector<std::uint32_t>> listed_;
  std::size_t stretches_ = 0;  ///< number of leaves of the tree, a power of two, at least the number of stretches
  std::uint32_t polygons_ = 0;
};

}  // namespace pointsweep::formulas
