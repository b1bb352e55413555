// SPDX-License-Identifier: MIT
/// Measures of how crowded points are: radius outliers, densities, local outlier factors.

#include <algorithm>
#include <numbers>

#include "pointsweep/verify/formulas/distances.h"

namespace pointsweep::formulas {
namespace {

constexpr Real kMissing = std::numeric_limits<Real>::quiet_NaN();

Estimate exactly(Real value) { return {.value = {value, 0, 0}}; }

/// The least and the greatest possible number of neighbours within the radius.
struct Within {
  std::size_t sure = 0, possible = 0;

  Within(const Place& p, std::span<const Place> neighbors, double radius) {
    for (const Place& q : neighbors) {
      const double d2 = squared_distance(p, q);
      const Real doubt = distance(p, q).error, length = std::sqrt(static_cast<Real>(d2));
      if (doubt == 0) {
        sure += d2 <= radius * radius, possible += d2 <= radius * radius;
      } else {
        sure += length + doubt < radius, possible += length - doubt <= radius;
      }
    }
  }
};

Real as_single(Real v) { return std::min<Real>(v, std::numeric_limits<float>::max()); }

/// Returns `points` divided by the size of a disc or a ball: `factor` times the radius to the power `power`.
Estimate per_size(Real points, const Estimate& radius, int power, Real factor) {
  const Real r = radius.value.x;
  if (radius.error > 0.5L * r) return open();
  const auto quotient = [&](Real at) { return as_single(points / (factor * std::pow(at, power))); };
  const Real rounding = 32 * kDouble * quotient(r);
  return single_scalar(quotient(r), {quotient(r + radius.error) - rounding, quotient(r - radius.error) + rounding});
}

}  // namespace

Estimate radius_outlier(const Place& p, std::span<const Place> neighbors, double radius, std::size_t least) {
  const Within within(p, neighbors, radius);
  if (within.sure >= least) return exactly(0);
  return within.possible < least ? exactly(1) : open();
}

Estimate core_point(const Place& p, std::span<const Place> neighbors, double eps, std::size_t least) {
  const Within within(p, neighbors, eps);
  if (within.sure + 1 >= least) return exactly(1);
  return within.possible + 1 < least ? exactly(0) : open();
}

Densities densities(const Place& p, std::span<const Place> neighbors, std::optional<double> radius) {
  const Estimate reach = radius ? exactly(*radius) : farthest(p, neighbors);
  if (!std::isfinite(reach.value.x)) return {};
  if (reach.value.x == 0) return reach.error > 0 ? Densities{open(), open()} : Densities{};
  Real points = static_cast<Real>(neighbors.size());
  if (radius) {
    const Within within(p, neighbors, *radius);
    if (within.sure != within.possible) return {open(), open()};
    points = static_cast<Real>(within.sure) + 1;
  }
  constexpr Real pi = std::numbers::pi_v<Real>;
  return {per_size(points, reach, 2, pi), per_size(points, reach, 3, 4 * pi / 3)};
}

Estimate k_distance(const Place& p, std::span<const Place> neighbors) {
  const Estimate d = farthest(p, neighbors);
  return neighbors.empty() || !std::isfinite(d.value.x) ? exactly(kMissing) : d;
}

Estimate reachability_density(const Place& p, std::span<const Place> neighbors, std::span<const Estimate> k_distances) {
  Real sum = 0, error = 0;
  for (std::size_t j = 0; j < neighbors.size(); ++j) {
    const Estimate d = distance(p, neighbors[j]), &k = k_distances[j];
    if (k.is_open()) return open();
    if (std::isnan(k.value.x) || !std::isfinite(d.value.x)) return exactly(kMissing);
    sum += std::max(k.value.x, d.value.x), error += std::max(k.error, d.error);
  }
  if (neighbors.empty()) return exactly(kMissing);
  if (sum == 0 && error == 0) return exactly(kInfinity);
  error += rounding_of_sum(neighbors.size()) * sum;
  const Real n = static_cast<Real>(neighbors.size());
  if (error > 0.5L * sum) return open();
  return {.value = {n / sum, 0, 0}, .error = n / (sum - error) - n / sum};
}

Estimate local_outlier_factor(const Estimate& density, std::span<const Estimate> of_neighbors) {
  const auto any = [&](auto test) {
    return test(density) || std::any_of(of_neighbors.begin(), of_neighbors.end(), test);
  };
  if (any([](const Estimate& e) { return e.is_open(); })) return open();
  if (of_neighbors.empty() || any([](const Estimate& e) { return std::isnan(e.value.x); })) return exactly(kMissing);
  const Real own = density.value.x, n = static_cast<Real>(of_neighbors.size());
  const bool own_infinite = std::isinf(own);
  Real sum = 0, error = 0;
  for (const Estimate& e : of_neighbors) {
    const Real r = e.value.x;
    if (std::isinf(r) && !own_infinite) return exactly(kInfinity);
    if (own_infinite) {
      sum += std::isinf(r) ? 1 : 0;
    } else {
      sum += r / own, error += e.error / own + r / own * density.error / (own - density.error);
    }
  }
  const Real rounding = own_infinite ? 2 * kDouble * sum : 2 * rounding_of_sum(of_neighbors.size()) * sum;
  return {.value = {sum / n, 0, 0}, .error = (2 * error + rounding) / n};
}

}  // namespace pointsweep::formulas
