// SPDX-License-Identifier: MIT
#include "pointsweep/verify/formulas/cylinder.h"

namespace pointsweep::formulas {
namespace {

Estimate number(Real value, Real error) { return scalar(value, error + kDouble * std::fabs(value)); }

}  // namespace

Cylinder::Cylinder(Vector center, const Estimate& normal, Real diameter, Real depth)
    : center_(center), radius_(diameter / 2), depth_(depth) {
  const Real size = norm(normal.value);
  if (is_finite(normal.value)) axis_ = unit(normal.value);
  open_ = in_doubt(normal) || (size > 0 && normal.error >= size / 2);
  error_ = (size > 0 ? normal.error / size : 0) + 8 * kDouble;
}

Real Cylinder::reach2() const { return (radius_ * radius_ + depth_ * depth_) * (1 + 1e-9L) + 1e-290L; }

/// Adds a point if it is inside. is_open() becomes true if the distance of the point from the surface is not more than
/// the errors of the axis and of rounding.
void Cylinder::add(Vector point) {
  const Vector offset = point - center_;
  const Real far = norm(offset), along = dot(offset, axis_), aside = norm(cross(offset, axis_));
  const Real slack = 2 * error_ * far;
  const bool inside = std::fabs(along) <= depth_ && aside <= radius_;
  const bool near_edge = std::fabs(std::fabs(along) - depth_) <= slack || std::fabs(aside - radius_) <= slack;
  const bool maybe = std::fabs(along) <= depth_ + slack && aside <= radius_ + slack;
  open_ = open_ || (near_edge && maybe);
  if (!inside) return;
  if (count_++ == 0) first_ = along;
  const Real b = along - first_;
  sum_ += b, squares_ += b * b;
  largest_ = std::max(largest_, far);
}

Estimate Cylinder::mean() const {
  if (count_ == 0) return exactly(kNaN);
  const Real m = first_ + sum_ / static_cast<Real>(count_);
  return number(m, (error_ + rounding_of_sum(count_)) * largest_);
}

/// The error of the deviation: if each a_j changes by at most e, the deviation changes by at most e sqrt(n / (n - 1)).
Estimate Cylinder::spread() const {
  if (count_ < 2) return exactly(kNaN);
  const auto n = static_cast<Real>(count_);
  const Real variance = std::max<Real>(0, (squares_ - sum_ * sum_ / n) / (n - 1));
  const Real lost = 0x1p-61L * n * squares_ / (n - 1);  // rounding error of the sums
  const Real s = std::sqrt(variance), of_sums = lost / (s + std::sqrt(lost) + 1e-300L);
  return number(s, 2 * (error_ + rounding_of_sum(count_)) * largest_ + of_sums);
}

Change change(const Cylinder& before, const Cylinder& after, Real registration, bool either_side) {
  const auto all_of = [](const Estimate& e) { return Change{e, e, e, e, e, e}; };
  if (before.is_open() || after.is_open()) return all_of(open());
  if (!before.has_axis()) {
    const Estimate nan = exactly(kNaN);
    return {nan, nan, nan, nan, {}, {}};
  }
  const Estimate m1 = before.mean(), m2 = after.mean(), s1 = before.spread(), s2 = after.spread();
  const auto n1 = static_cast<Real>(before.count()), n2 = static_cast<Real>(after.count());
  Change c{.distance = number(m2.value.x - m1.value.x, m1.error + m2.error),
           .level = {},
           .spread1 = s1,
           .spread2 = s2,
           .samples1 = exactly(n1),
           .samples2 = exactly(n2)};
  const Real uncertainty = std::sqrt(s1.value.x * s1.value.x / n1 + s2.value.x * s2.value.x / n2);
  const Real level = 1.96L * (uncertainty + registration);
  c.level = number(level, 1.96L * (s1.error / std::sqrt(n1) + s2.error / std::sqrt(n2)) + 16 * kDouble * level);
  c.distance.either_sign = either_side;
  // A NaN value needs no error bound: only NaN equals it.
  for (Estimate* e : {&c.distance, &c.level})
    if (std::isnan(e->value.x)) *e = exactly(kNaN);
  return c;
}

}  // namespace pointsweep::formulas
