// SPDX-License-Identifier: MIT
#include "pointsweep/polygons/polygon_index.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pointsweep/math/exact_sum.h"

namespace pointsweep {
namespace {

int exact_orientation(Point2 a, Point2 b, Point2 c) {
  ExactSum sum;  // sum of the products of the determinant, without c.x * c.y, which cancels
  sum.add_product(a.x, b.y);
  sum.add_product(-a.x, c.y);
  sum.add_product(-c.x, b.y);
  sum.add_product(-a.y, b.x);
  sum.add_product(a.y, c.x);
  sum.add_product(c.y, b.x);
  return sum.sign();
}

constexpr std::size_t kMostEntriesOfEdge = 16;  ///< largest average number of strips per edge

}  // namespace

int orientation(Point2 a, Point2 b, Point2 c) {
  // Shewchuk's bound: the error of `difference` is at most (3 + 16u)u `size` with u = 2^-53, about 3.331e-16 `size`.
  // The bound does not hold if a product is subnormal, so a `size` up to kLeastSize is not trusted.
  constexpr double kBound = 3.4e-16, kLeastSize = 1e-290;
  const double left = (a.x - c.x) * (b.y - c.y), right = (a.y - c.y) * (b.x - c.x);
  const double difference = left - right, size = std::abs(left) + std::abs(right);
  if (size > kLeastSize && std::abs(difference) > kBound * size) return difference > 0 ? 1 : -1;
  return exact_orientation(a, b, c);
}

PolygonIndex::PolygonIndex(const std::vector<Polygon>& polygons) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  least_ = {kInfinity, kInfinity}, most_ = {-kInfinity, -kInfinity};
  for (std::size_t p = 0; p < polygons.size(); ++p)
    for (const Ring& ring : polygons[p].rings)
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const Point2 a = ring[i], b = ring[(i + 1) % ring.size()];
        edges_.push_back({a.y <= b.y ? a : b, a.y <= b.y ? b : a, static_cast<std::uint32_t>(p)});
        least_ = {std::min(least_.x, a.x), std::min(least_.y, a.y)};
        most_ = {std::max(most_.x, a.x), std::max(most_.y, a.y)};
      }
  fill_strips();
}

/// Returns the number of the strip of `y`. It never decreases as `y` increases, so an edge is in all strips from the
/// strip of its low end to the strip of its high end.
std::size_t PolygonIndex::strip_of(double y) const {
  const double strip = (y - least_.y) * scale_;
  return strip >= static_cast<double>(strips_ - 1) ? strips_ - 1 : static_cast<std::size_t>(std::max(strip, 0.0));
}

/// Divides the height into `strips` strips, and returns the sum of the numbers of edges that the strips hold. If the
/// height or the number of strips per unit is not finite, all edges lie in the first strip.
std::size_t PolygonIndex::entries(std::size_t strips) {
  strips_ = strips;
  const double height = most_.y - least_.y;
  const double scale = static_cast<double>(strips) / height;
  scale_ = std::isfinite(height) && std::isfinite(scale) ? scale : 0;
  std::size_t sum = 0;
  for (const Edge& e : edges_) sum += strip_of(e.high.y) - strip_of(e.low.y) + 1;
  return sum;
}

void PolygonIndex::fill_strips() {
  std::size_t strips = std::max<std::size_t>(edges_.size(), 1);
  while (entries(strips) > kMostEntriesOfEdge * edges_.size() && strips > 1) strips /= 2;
  first_.assign(strips_ + 1, 0);
  const auto for_each_strip = [&](const Edge& e, auto use) {
    for (std::size_t s = strip_of(e.low.y), last = strip_of(e.high.y); s <= last; ++s) use(s);
  };
  for (const Edge& e : edges_) for_each_strip(e, [&](std::size_t s) { ++first_[s + 1]; });
  for (std::size_t s = 0; s < strips_; ++s) first_[s + 1] += first_[s];
  in_strip_.resize(first_.back());
  std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
  for (std::size_t i = 0; i < edges_.size(); ++i)
    for_each_strip(edges_[i], [&](std::size_t s) { in_strip_[next[s]++] = static_cast<std::uint32_t>(i); });
}

/// Counts the edges that a ray from p towards +x crosses. An edge with an end at the y of p counts only if this end is
/// the lower end.
bool PolygonIndex::covers(Point2 p) const {
  if (!(p.x >= least_.x && p.x <= most_.x && p.y >= least_.y && p.y <= most_.y)) return false;
  bool inside = false;
  std::uint32_t polygon = 0;
  const std::size_t strip = strip_of(p.y);
  for (std::size_t i = first_[strip]; i < first_[strip + 1]; ++i) {
    const Edge& e = edges_[in_strip_[i]];
    if (e.polygon != polygon) {
      if (inside) return true;
      polygon = e.polygon;
    }
    if (p.y < e.low.y || p.y > e.high.y || (p.x > e.low.x && p.x > e.high.x)) continue;
    const bool is_left = p.x < e.low.x && p.x < e.high.x;
    // For a horizontal edge, orientation() is 0: a point at its height and between its ends lies on the edge.
    const int side = is_left ? 1 : orientation(e.low, e.high, p);
    if (side == 0) return true;
    if (side > 0 && p.y < e.high.y) inside = !inside;
  }
  return inside;
}

}  // namespace pointsweep
