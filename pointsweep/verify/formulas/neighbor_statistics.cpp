// SPDX-License-Identifier: MIT
#include "pointsweep/verify/formulas/neighbor_statistics.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace pointsweep::formulas {
namespace {

/// Returns the most frequent value; if several are equally frequent, the first of these in the list.
Real most_frequent(const std::vector<Real>& values) {
  std::map<Real, std::size_t> counts;
  for (const Real v : values) ++counts[v];
  Real best = values.front();
  for (const Real v : values)
    if (counts[v] > counts[best]) best = v;
  return best;
}

}  // namespace

Estimate statistic_of(std::string_view name, const std::vector<Estimate>& values) {
  std::vector<Real> v;
  Real error = 0;  // largest error of a value, which also bounds the error of order statistics and deviations
  for (const Estimate& e : values) {
    if (in_doubt(e) || e.either_sign) return open();
    if (!std::isfinite(e.value.x)) continue;
    v.push_back(e.value.x);
    error = std::max(error, e.error);
  }
  const auto n = static_cast<Real>(v.size());
  if (name == "count") return exactly(n);
  if (v.empty()) return exactly(kNaN);
  if (name == "majority") return error > 0 ? open() : exactly(most_frequent(v));

  Real sum = 0, far = 0;
  for (const Real value : v) sum += value - v[0], far = std::max(far, std::fabs(value - v[0]));
  const Real m = sum / n, rounding_of_m = kDouble * (n + 2) * far;
  if (name == "mean")
    return scalar(v[0] + m, error + rounding_of_m + kDouble * (std::fabs(v[0]) + std::fabs(v[0] + m)));
  if (name == "deviation") {
    Real squares = 0;
    for (const Real value : v) squares += (value - v[0] - m) * (value - v[0] - m);
    const Real deviation = std::sqrt(squares / n);
    return scalar(deviation, error + rounding_of_m + kDouble * (3 * far + (n + 4) * deviation));
  }
  std::ranges::sort(v);
  if (name == "min") return scalar(v.front(), error);
  if (name == "max") return scalar(v.back(), error);
  if (name == "range") return scalar(v.back() - v.front(), 2 * error + kDouble * (v.back() - v.front()));
  const Real median = (v[(v.size() - 1) / 2] + v[v.size() / 2]) / 2;
  return scalar(median, error + kDouble * std::fabs(median));
}

std::optional<Estimate> voted(std::string_view vote, const std::vector<Real>& values, bool are_whole) {
  if (values.empty()) return std::nullopt;
  if (vote == "nearest" || (vote == "majority" && values.size() == 1)) return exactly(values.front());
  std::vector<Estimate> finite;
  Real sum = 0;
  for (const Real v : values) {
    if (!std::isfinite(v)) continue;
    finite.push_back(exactly(v));
    sum += v;
  }
  if (finite.empty()) return std::nullopt;
  const bool is_exact = are_whole && std::fabs(sum) < 0x1p63L;  // a sum of whole numbers below 2^63 is exact
  if (vote == "mean" && is_exact) return exactly(static_cast<double>(sum) / static_cast<double>(finite.size()));
  return statistic_of(vote, finite);
}

Estimate stored(const Estimate& value, Storage storage) {
  if (value.is_open()) return open();
  const Real v = value.value.x;
  if (value.error > 0) return stored_number({v - value.error, v + value.error, false}, storage);
  return stored_number({v, v, storage == Storage::whole && std::nearbyint(v) == v}, storage);
}

}  // namespace pointsweep::formulas
