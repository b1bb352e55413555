// SPDX-License-Identifier: MIT
#include "pointsweep/verify/formulas/normal.h"

#include "pointsweep/verify/formulas/weighted_neighbors.h"

namespace pointsweep::formulas {
namespace {

/// Turns `n` so that its product with something is positive; false where the product is 0 or may be.
bool turn(Estimate& n, Real product, Real error) {
  if (std::fabs(product) <= error) return false;
  if (product < 0) n.value = Real{-1} * n.value;
  return true;
}

/// Positive by the component of largest magnitude; components that may be as large must agree in sign.
void turn_by_largest(Estimate& n) {
  const Real c[3] = {n.value.x, n.value.y, n.value.z};
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

Estimate normal(const Place& p, std::span<const Place> neighbors, const Facing& facing) {
  if (neighbors.size() < 2) return undefined();
  const WeightedNeighbors weighted = weigh(p, neighbors);
  if (!weighted.finite) return undefined();
  if (weighted.farthest <= weighted.farthest_error) return weighted.farthest > 0 ? open() : undefined();
  const Spectrum s = equation1(weighted);
  const Real rho = 0x1p-51L * largest_component(p.at);
  const Real limit = 1e-12L * s.value[2] + rho * rho * weighted.mean_weight();
  const Real doubt = s.value_error[1] + 1e-12L * s.value_error[2] + 1e-5L * limit;
  if (s.value[1] + doubt <= limit) return undefined();
  Estimate n = single_direction(s.vector[0], s.vector_error[0]);
  n.may_be_undefined = s.value[1] - doubt <= limit;
  if (n.is_open()) n.either_sign = true;
  orient(n, p, facing);
  return n;
}

}  // namespace pointsweep::formulas
