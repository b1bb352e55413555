// SPDX-License-Identifier: MIT
#include "pointsweep/verify/formulas/regions.h"

#include <algorithm>
#include <bit>
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

/// Returns whether p is above (1), on (0) or below (-1) the line from a to b, where a is to the left of b.
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

/// Returns side_of(). Needs no exact arithmetic if p is above or below both ends of the edge, as most points are.
int quick_side_of(const Corner& p, const Corner& a, const Corner& b) {
  if (p[1] > a[1] && p[1] > b[1]) return 1;
  if (p[1] < a[1] && p[1] < b[1]) return -1;
  return side_of(p, a, b);
}

}  // namespace

bool is_in_box(const std::array<double, 3>& p, std::span<const double> bounds) {
  const std::size_t axes = bounds.size() / 2;
  for (std::size_t a = 0; a < axes; ++a)
    if (std::isnan(p[a]) || p[a] < bounds[a] || p[a] > bounds[axes + a]) return false;
  return true;
}

EdgesAlongX::EdgesAlongX(std::span<const PolygonRings> polygons) {
  for (const PolygonRings& rings : polygons) {
    for (const auto& ring : rings)
      for (std::size_t i = 0; i < ring.size(); ++i) {
        Corner a = ring[i], b = ring[i + 1 == ring.size() ? 0 : i + 1];
        if (a[0] > b[0]) std::swap(a, b);
        edges_.push_back({a, b, polygons_});
        ends_.push_back(a[0]), ends_.push_back(b[0]);
      }
    ++polygons_;
  }
  std::ranges::sort(ends_);
  ends_.erase(std::unique(ends_.begin(), ends_.end()), ends_.end());
  stretches_ = std::bit_ceil(2 * ends_.size() + 1);
  listed_.resize(2 * stretches_);
  for (std::uint32_t e = 0; e < edges_.size(); ++e) list(e, 1, 0, stretches_ - 1);
}

/// Adds an edge to the nodes of the tree. `node` covers the stretches from `first` to `last`.
void EdgesAlongX::list(std::uint32_t edge, std::size_t node, std::size_t first, std::size_t last) {
  const auto at = [&](double x) {
    return 2 * static_cast<std::size_t>(std::ranges::lower_bound(ends_, x) - ends_.begin());
  };
  const std::size_t begin = at(edges_[edge].left[0]), end = at(edges_[edge].right[0]);
  if (begin > last || end < first) return;
  if (begin <= first && last <= end) return listed_[node].push_back(edge);
  const std::size_t middle = (first + last) / 2;
  list(edge, 2 * node, first, middle);
  list(edge, 2 * node + 1, middle + 1, last);
}

bool EdgesAlongX::hold(const Corner& p) const {
  if (!std::isfinite(p[0]) || !std::isfinite(p[1])) return false;
  const auto above = std::ranges::upper_bound(ends_, p[0]);
  if (above == ends_.begin()) return false;
  const auto i = static_cast<std::size_t>(above - ends_.begin()) - 1;
  std::vector<std::uint32_t> crossed;  // numbers of polygons, one entry for each of their edges above p
  for (std::size_t node = stretches_ + 2 * i + (ends_[i] == p[0] ? 0 : 1); node > 0; node /= 2) {
    for (const std::uint32_t number : listed_[node]) {
      const Edge& e = edges_[number];
      if (e.left[0] == e.right[0]) {  // a vertical edge, which the vertical ray from p does not cross
        if (p[1] >= std::min(e.left[1], e.right[1]) && p[1] <= std::max(e.left[1], e.right[1])) return true;
        continue;
      }
      const int side = quick_side_of(p, e.left, e.right);
      if (side == 0) return true;
      // An edge counts if p is to the right of its left end. If two edges meet exactly above p, one counts if the edges
      // lie on different sides of the vertical through p; otherwise both or none count, which does not change the
      // parity.
      if (side < 0 && p[0] > e.left[0]) crossed.push_back(e.polygon);
    }
  }
  std::ranges::sort(crossed);
  for (std::size_t c = 0; c < crossed.size();) {
    std::size_t end = c;
    while (end < crossed.size() && crossed[end] == crossed[c]) ++end;
    if ((end - c) % 2 == 1) return true;
    c = end;
  }
  return false;
}

}  // namespace pointsweep::formulas
