// SPDX-License-Identifier: MIT
/// An index of polygons that decides whether points lie in them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pointsweep {

struct Point2 {
  double x = 0, y = 0;
  friend bool operator==(const Point2&, const Point2&) = default;
};

/// Returns the sign of (a - c) x (b - c): 1 if c lies to the left of the line from a to b, -1 if to the right, 0 if the
/// three points lie on one line. Exact for all finite doubles: if float64 cannot decide, an exact sum does (Shewchuk,
/// "Adaptive precision floating-point arithmetic and fast robust geometric predicates", 1997, has the bound).
int orientation(Point2 a, Point2 b, Point2 c);

/// A closed ring of at least three finite points, without a repetition of the first point at its end.
using Ring = std::vector<Point2>;

/// The area inside of rings by the even-odd rule: a ring inside of another ring is a hole, in either orientation.
struct Polygon {
  std::vector<Ring> rings;
  friend bool operator==(const Polygon&, const Polygon&) = default;
};

/// The union of closed polygons. Points exactly on an edge, even of a hole, are covered. All decisions are exact. Edges
/// are listed by strips of y, so that a point is compared with few edges.
class PolygonIndex {
 public:
  explicit PolygonIndex(const std::vector<Polygon>& polygons);
  /// Returns whether the point is covered; false for a point that is not finite.
  bool covers(Point2 p) const;

 private:
  struct Edge {
    Point2 low, high;  ///< ends of the edge, with low.y <= high.y
    std::uint32_t polygon = 0;
  };
  std::size_t strip_of(double y) const;
  std::size_t entries(std::size_t strips);
  void fill_strips();

  Point2 least_, most_;  ///< corners of the box around all edges
  double scale_ = 0;     ///< number of strips per unit of y
  std::size_t strips_ = 1;
  std::vector<Edge> edges_;              ///< edges of one polygon follow one another
  std::vector<std::size_t> first_;       ///< index of each strip's first entry in in_strip_, then the number of entries
  std::vector<std::uint32_t> in_strip_;  ///< indices of edges, ascending in each strip
};

}  // namespace pointsweep
