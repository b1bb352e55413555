// SPDX-License-Identifier: MIT
#include "pointsweep/polygons/orientation.h"

#include <cmath>

#include "pointsweep/math/exact_sum.h"

namespace pointsweep {
namespace {

int exact_orientation(Point2 a, Point2 b, Point2 c) {
  ExactSum sum;  // the products of the determinant; c.x * c.y cancels
  sum.add_product(a.x, b.y);
  sum.add_product(-a.x, c.y);
  sum.add_product(-c.x, b.y);
  sum.add_product(-a.y, b.x);
  sum.add_product(a.y, c.x);
  sum.add_product(c.y, b.x);
  return sum.sign();
}

}  // namespace

int orientation(Point2 a, Point2 b, Point2 c) {
  // Shewchuk's bound is (3 + 16u)u with u = 2^-53, 3.34e-16. Below the least size products may be subnormal.
  constexpr double kBound = 3.4e-16, kLeastSize = 1e-290;
  const double left = (a.x - c.x) * (b.y - c.y), right = (a.y - c.y) * (b.x - c.x);
  const double difference = left - right, size = std::abs(left) + std::abs(right);
  if (size > kLeastSize && std::abs(difference) > kBound * size) return difference > 0 ? 1 : -1;
  return exact_orientation(a, b, c);
}

}  // namespace pointsweep
