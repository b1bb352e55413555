// SPDX-License-Identifier: MIT
/// The side of a line on which a point lies, exactly.
#pragma once

namespace pointsweep {

struct Point2 {
  double x = 0, y = 0;
  friend bool operator==(const Point2&, const Point2&) = default;
};

/// The sign of (a - c) x (b - c): 1 if c lies to the left of the line from a to b, -1 if to the right, 0 if the three
/// lie on one line. Exact for all finite doubles: what float64 leaves open is decided by an exact sum (Shewchuk,
/// "Adaptive precision floating-point arithmetic and fast robust geometric predicates", 1997, has the bound).
int orientation(Point2 a, Point2 b, Point2 c);

}  // namespace pointsweep
