// SPDX-License-Identifier: MIT
#include "pointsweep/verify/formulas/regions.h"

#include <algorithm>
#include <cmath>

namespace pointsweep::formulas {
namespace {

/// A sum of doubles as a sum of parts that do not overlap, ascending (Shewchuk 1997, Grow-Expansion).
class PartsOfSum {
 public:
  void add(double term) {
    for (double& part : parts_) {
      const double sum = part + term, shared = sum - part;
      part = (part - (sum - shared)) + (term - shared);
      term = sum;
    }
    parts_.push_back(term);
  }
  void add_product(double a, double b) {
    const double product = a * b;
    add(std::fma(a, b, -product));
    add(product);
  }
  int sign() const {
    for (std::size_t i = parts_.size(); i-- > 0;)
      if (parts_[i] != 0) return parts_[i] > 0 ? 1 : -1;
    return 0;
  }

 private:
  std::vector<double> parts_;
};

/// Above (1), on (0) or below (-1) the line from a to b, a left of b.
int side_of(const Corner& p, Corner a, Corner b) {
  double most = 0;
  for (const double c : {p[0], p[1], a[0], a[1], b[0], b[1]}) most = std::max(most, std::fabs(c));
  const int down = most > 0 ? -std::ilogb(most) : 0;
  const auto scaled = [&](double c) { return std::ldexp(c, down); };
  const double px = scaled(p[0]), py = scaled(p[1]), ax = scaled(a[0]), ay = scaled(a[1]), bx = scaled(b[0]),
               by = scaled(b[1]);
  // (b - a) x (p - a)
  PartsOfSum sum;
  sum.add_product(bx, py);
  sum.add_product(-bx, ay);
  sum.add_product(-ax, py);
  sum.add_product(-by, px);
  sum.add_product(by, ax);
  sum.add_product(ay, px);
  return sum.sign();
}

bool is_in_polygon(const Corner& p, const PolygonRings& rings) {
  bool inside = false;
  for (const auto& ring : rings) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      Corner a = ring[i], b = ring[i + 1 == ring.size() ? 0 : i + 1];
      if (a[0] > b[0]) std::swap(a, b);
      if (p[0] < a[0] || p[0] > b[0]) continue;
      if (a[0] == b[0]) {  // upright: the ray from p straight up does not cross it
        if (p[1] >= std::min(a[1], b[1]) && p[1] <= std::max(a[1], b[1])) return true;
        continue;
      }
      const int side = side_of(p, a, b);
      if (side == 0) return true;
      if (side < 0 && p[0] > a[0]) inside = !inside;  // of two edges that meet above p one counts, or both or none
    }
  }
  return inside;
}

}  // namespace

bool is_in_box(const std::array<double, 3>& p, std::span<const double> bounds) {
  const std::size_t axes = bounds.size() / 2;
  for (std::size_t a = 0; a < axes; ++a)
    if (std::isnan(p[a]) || p[a] < bounds[a] || p[a] > bounds[axes + a]) return false;
  return true;
}

bool is_in_polygons(const Corner& p, std::span<const PolygonRings> polygons) {
  if (!std::isfinite(p[0]) || !std::isfinite(p[1])) return false;
  return std::any_of(polygons.begin(), polygons.end(),
                     [&](const PolygonRings& rings) { return is_in_polygon(p, rings); });
}

}  // namespace pointsweep::formulas
