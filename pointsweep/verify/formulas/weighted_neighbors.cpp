// SPDX-License-Identifier: MIT
#include "pointsweep/verify/formulas/weighted_neighbors.h"

#include <numbers>

namespace pointsweep::formulas {
namespace {

/// Flips `n` if `product`, its scalar product with another vector, is negative. Returns false, without a change, if the
/// product may be 0.
bool turn(Estimate& n, Real product, Real error) {
  if (std::fabs(product) <= error) return false;
  if (product < 0) n.value = Real{-1} * n.value;
  return true;
}

/// Flips `n` so that its component of largest magnitude is positive. The sign is uncertain if another component may be
/// as large and has the other sign.
void turn_by_largest(Estimate& n) {
  const Vector& c = n.value;
  std::size_t largest = 0;
  for (std::size_t a = 1; a < 3; ++a)
    if (std::fabs(c[a]) > std::fabs(c[largest])) largest = a;
  for (std::size_t a = 0; a < 3; ++a)
    if (std::fabs(c[largest]) - std::fabs(c[a]) <= 2 * n.error && c[a] * c[largest] < 0) n.either_sign = true;
  turn(n, c[largest], 0);
}

void orient(Estimate& n, const Place& p, const Facing& facing) {
  turn_by_largest(n);
  const bool free = n.either_sign;
  n.either_sign = false;
  switch (facing.side) {
    case Facing::Side::none:
      n.either_sign = free;
      return;
    case Facing::Side::up:
      if (!turn(n, n.value.z, n.error)) n.either_sign = free || n.value.z != 0;
      return;
    case Facing::Side::viewpoint: {
      const Vector sight = facing.viewpoint - p.at;
      const Real product = dot(sight, n.value), error = norm(sight) * (n.error + 8 * kDouble) + p.error;
      if (!turn(n, product, error)) n.either_sign = free || product != 0;
      return;
    }
    case Facing::Side::like: {
      const Estimate& like = facing.like;
      const Real product = dot(like.value, n.value), error = norm(like.value) * n.error + like.error;
      if (!turn(n, product, error)) n.either_sign = free || product != 0;
      if (like.either_sign) n.either_sign = true;
    }
  }
}

}  // namespace

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
    result.finite = result.finite && fits_double(d);
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
  if (std::fabs(std::fabs(lift) - std::fabs(lift_across)) <= 4 * error) {  // either vector may be the chosen one
    const Vector other = unit(projected ? turned : flat);
    t.error += std::min(norm(t.value - other), norm(t.value + other));
  }
  if (!(t.error < 1)) t.error = kInfinity;
  return t;
}

Estimate normal(const Place& p, std::span<const Place> neighbors, const Facing& facing) {
  if (neighbors.size() < 2) return undefined();
  const WeightedNeighbors weighted = weigh(p, neighbors);
  if (!weighted.finite) return undefined();
  if (weighted.farthest <= weighted.farthest_error) return weighted.farthest > 0 ? open() : undefined();
  const Spectrum s = equation1(weighted);
  const PlaneDoubt no_plane = no_plane_in(s, p, weighted.mean_weight());
  if (no_plane.sure) return undefined();
  Estimate n = single_direction(s.vector[0], s.vector_error[0]);
  n.may_be_undefined = no_plane.possible;
  if (n.is_open()) n.either_sign = true;
  orient(n, p, facing);
  return n;
}

}  // namespace pointsweep::formulas
