// SPDX-License-Identifier: MIT
#include "pointsweep/verify/formulas/weighted_neighbors.h"

#include <numbers>

namespace pointsweep::formulas {

Real WeightedNeighbors::mean_weight() const {
  Real sum = 0;
  for (const WeightedOffset& o : offsets) sum += o.weight;
  return sum / static_cast<Real>(offsets.size());
}

WeightedNeighbors weigh(const Place& p, std::span<const Place> neighbors) {
  WeightedNeighbors result;
  Real nearest = kInfinity;
  for (const Place& q : neighbors) {
    const Vector d = q.at - p.at;
    const Real r = norm(d);
    result.finite = result.finite && is_finite(d) && largest_component(d) <= std::numeric_limits<double>::max();
    result.offsets.push_back({.d = d, .error = p.error + q.error});
    result.farthest = std::max(result.farthest, r);
    result.farthest_error = std::max(result.farthest_error, p.error + q.error);
    if (r > 0) nearest = std::min(nearest, r);
  }
  if (!(result.farthest > 0) || !result.finite) return result;
  const Real count = static_cast<Real>(neighbors.size());
  const Real per_r2 = count / (2 * std::numbers::pi_v<Real> * result.farthest * result.farthest);  // 1 / 2σ²
  result.theta_of_nearest = std::exp(-per_r2 * nearest * nearest);
  for (WeightedOffset& o : result.offsets) {
    const Real r = norm(o.d), x = per_r2 * r * r;
    const Real moved = 2 * per_r2 * r * o.error + 2 * x * result.farthest_error / result.farthest;
    o.weight = std::exp(per_r2 * nearest * nearest - x);
    o.weight_error = o.weight * (single_weight_error(x) + moved);
  }
  return result;
}

Spectrum equation1(const WeightedNeighbors& neighbors) {
  const auto count = static_cast<Real>(neighbors.offsets.size());
  Matrix m;
  for (const WeightedOffset& o : neighbors.offsets) m.add_outer_product(o.weight / count, o.d);
  return spectrum_of(m, [&](Vector u, Vector v) {
    Real sum = 0;
    for (const WeightedOffset& o : neighbors.offsets) {
      const Real along_u = std::fabs(dot(u, o.d)), along_v = std::fabs(dot(v, o.d));
      sum += o.weight_error * along_u * along_v + o.weight * o.error * (along_u + along_v + o.error);
    }
    return sum / count + rounding_of_sum(neighbors.offsets.size()) * m.trace();
  });
}

Estimate tangent(Vector n, Vector along, Vector across, Real error) {
  const Real lift = dot(n, along), lift_across = dot(n, across);
  const Vector flat = along - lift * n, turned = cross(across, n);
  const bool projected = std::fabs(lift) <= std::fabs(lift_across);
  const Vector chosen = projected ? flat : turned;
  Estimate t{.value = unit(chosen), .error = 2 * error / norm(chosen), .either_sign = true};
  if (std::fabs(std::fabs(lift) - std::fabs(lift_across)) <= 4 * error) {  // either may decide
    const Vector other = unit(projected ? turned : flat);
    t.error += std::min(norm(t.value - other), norm(t.value + other));
  }
  if (!(t.error < 1)) t.error = kInfinity;
  return t;
}

}  // namespace pointsweep::formulas
