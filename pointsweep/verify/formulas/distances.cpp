// SPDX-License-Identifier: MIT
#include "pointsweep/verify/formulas/distances.h"

#include <algorithm>
#include <numbers>
#include <tuple>

#include "pointsweep/verify/formulas/eigen.h"

namespace pointsweep::formulas {
namespace {

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

/// The eigenentropy E of a covariance, and a bound of its error.
struct Entropy {
  Real value = kInfinity, error = 0;
};

Entropy entropy(const Matrix& covariance, Real rounding) {
  const Real trace = covariance.trace();
  Entropy result{0, 0};
  for (const Real value : eigen_of(covariance).value) {
    const Real e = std::max<Real>(value, 0) / trace, least = std::max(e, rounding / trace);
    if (e > 0) result.value -= e * std::log(e);
    result.error += rounding / trace * (1 + std::fabs(std::log(least)));
  }
  return result;
}

/// Returns the eigenentropies for k = least, least + 1, and so on; infinite for a k whose neighbours all coincide with
/// p.
std::vector<Entropy> entropies(const Place& p, std::span<const Place> neighbors, std::size_t least) {
  std::vector<Entropy> result;
  Matrix squares;
  Vector sum;
  for (std::size_t k = 1; k <= neighbors.size(); ++k) {
    const Vector d = neighbors[k - 1].at - p.at;
    squares.add_outer_product(1, d);
    sum = sum + d;
    if (k < least) continue;
    Matrix covariance = squares;
    covariance.add_outer_product(-1 / static_cast<Real>(k + 1), sum);
    const bool extended = squares.trace() > 0;
    result.push_back(extended ? entropy(covariance, rounding_of_sum(k) * squares.trace()) : Entropy{});
  }
  return result;
}

}  // namespace

double squared_distance(const Place& p, const Place& q) {
  const auto part = [](Real a, Real b) { return static_cast<double>(a) - static_cast<double>(b); };
  const double dx = part(q.at.x, p.at.x), dy = part(q.at.y, p.at.y), dz = part(q.at.z, p.at.z);
  return (dx * dx + dy * dy) + dz * dz;
}

Estimate distance(const Place& p, const Place& q) {
  const double length = std::sqrt(squared_distance(p, q));
  const Real moved = p.error + q.error;
  return scalar(length, moved > 0 ? moved + 4 * kDouble * length : 0);
}

Estimate farthest(const Place& p, std::span<const Place> neighbors) {
  Estimate result;
  for (const Place& q : neighbors) {
    const Estimate d = distance(p, q);
    if (std::isnan(d.value.x)) return d;
    result.value.x = std::max(result.value.x, d.value.x);
    result.error = std::max(result.error, d.error);
  }
  return result;
}

Estimate mean_distance(const Place& p, std::span<const Place> neighbors, bool of_open3d) {
  Estimate mean;
  const Real n = static_cast<Real>(neighbors.size()) + (of_open3d ? 1 : 0);
  for (const Place& q : neighbors) {
    const Estimate d = distance(p, q);
    mean.value.x += d.value.x / n;
    mean.error += d.error / n;
  }
  if (neighbors.empty() || !std::isfinite(mean.value.x)) return exactly(kNaN);
  mean.error += rounding_of_sum(neighbors.size()) * mean.value.x;
  return mean;
}

Estimate outlier(const Estimate& mean_distance, Real threshold, Real threshold_error, OutlierProgram program) {
  const Real mean = mean_distance.value.x;
  if (program == OutlierProgram::open3d && mean == 0 && mean_distance.error == 0) return exactly(1);
  if (mean_distance.is_open() || std::isnan(threshold)) return open();
  const bool at_threshold = program == OutlierProgram::pdal || program == OutlierProgram::open3d;
  if (threshold == 0 && threshold_error == 0 && mean == 0 && mean_distance.error == 0)
    return exactly(at_threshold ? 1 : 0);
  if (std::fabs(mean - threshold) <= mean_distance.error + threshold_error) return open();
  return exactly(mean <= threshold ? 0 : 1);
}

GraphRow graph_row(const Place& p, std::span<const Place> neighbors, std::span<const std::uint64_t> rows) {
  GraphRow row;
  for (std::size_t j = 0; j < neighbors.size(); ++j)
    row.neighbors.push_back({distance(p, neighbors[j]), squared_distance(p, neighbors[j]), j});
  const auto key = [&](const GraphNeighbor& n) {
    const Vector at = is_finite(neighbors[n.index].at) ? neighbors[n.index].at : Vector{};
    const bool nowhere = std::isnan(n.distance2);
    return std::tuple(nowhere, nowhere ? 0 : n.distance2, at.x, at.y, at.z, rows[n.index]);
  };
  std::ranges::sort(row.neighbors, [&](const GraphNeighbor& a, const GraphNeighbor& b) { return key(a) < key(b); });
  for (std::size_t j = 1; j < row.neighbors.size(); ++j) {
    const Estimate &a = row.neighbors[j - 1].distance, &b = row.neighbors[j].distance;
    row.certain = row.certain && (b.value.x - a.value.x > a.error + b.error || a.error + b.error == 0);
  }
  return row;
}

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
  return neighbors.empty() || !std::isfinite(d.value.x) ? exactly(kNaN) : d;
}

Estimate reachability_density(const Place& p, std::span<const Place> neighbors, std::span<const Estimate> k_distances) {
  Real sum = 0, error = 0;
  for (std::size_t j = 0; j < neighbors.size(); ++j) {
    const Estimate d = distance(p, neighbors[j]), &k = k_distances[j];
    if (k.is_open()) return open();
    if (std::isnan(k.value.x) || !std::isfinite(d.value.x)) return exactly(kNaN);
    sum += std::max(k.value.x, d.value.x), error += std::max(k.error, d.error);
  }
  if (neighbors.empty()) return exactly(kNaN);
  if (sum == 0 && error == 0) return exactly(kInfinity);
  error += rounding_of_sum(neighbors.size()) * sum;
  const Real n = static_cast<Real>(neighbors.size());
  if (error > 0.5L * sum) return open();
  return scalar(n / sum, n / (sum - error) - n / sum);
}

Estimate local_outlier_factor(const Estimate& density, std::span<const Estimate> of_neighbors) {
  const auto any = [&](auto test) { return test(density) || std::ranges::any_of(of_neighbors, test); };
  if (any([](const Estimate& e) { return e.is_open(); })) return open();
  if (of_neighbors.empty() || any([](const Estimate& e) { return std::isnan(e.value.x); })) return exactly(kNaN);
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
  return scalar(sum / n, (2 * error + rounding) / n);
}

Kept of_least_eigenentropy(const Place& p, std::span<const Place> neighbors, std::size_t least) {
  if (neighbors.size() <= least) return {neighbors.size(), true};
  const std::vector<Entropy> all = entropies(p, neighbors, least);
  std::size_t best = 0;
  for (std::size_t m = 1; m < all.size(); ++m)
    if (all[m].value < all[best].value) best = m;
  if (!(all[best].value < kInfinity)) return {neighbors.size(), true};
  Kept kept{least + best, true};
  for (std::size_t m = 0; m < all.size(); ++m)
    if (m != best && all[m].value - all[best].value <= all[m].error + all[best].error) kept.certain = false;
  return kept;
}

Kept within_limits(const Place& p, std::span<const Place> neighbors, std::optional<double> k,
                   std::optional<double> radius) {
  std::size_t count = neighbors.size();
  if (k) count = *k >= 1 ? static_cast<std::size_t>(std::min(std::floor(*k), static_cast<double>(count))) : 0;
  if (!radius) return {count, true};
  const auto is_within = [&](const Place& q) { return squared_distance(p, q) <= *radius * *radius; };
  std::size_t within = 0;
  while (within < count && *radius >= 0 && is_within(neighbors[within])) ++within;
  return {within, true};
}

}  // namespace pointsweep::formulas
