// SPDX-License-Identifier: MIT
/// Rules that decide how many of its found neighbours a point keeps.

#include "pointsweep/verify/formulas/distances.h"
#include "pointsweep/verify/formulas/eigen.h"

namespace pointsweep::formulas {
namespace {

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
