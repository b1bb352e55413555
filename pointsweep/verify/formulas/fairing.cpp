// SPDX-License-Identifier: MIT
/// Feature-preserving smoothing: Equation 3 of the paper.
#include <numbers>
#include <vector>

#include "pointsweep/verify/formulas/surface.h"

namespace pointsweep::formulas {
namespace {

struct Pull {
  Vector shift;  ///< Π_j(p_i) - p_i
  Real shift_error = 0;
  Real weight = 0;
  Real weight_error = 0;  ///< relative error of the weight
};

struct Area {
  Real value = 0;
  Real error = 0;  ///< relative error of the value
};

Area area(const Surfel& s) {
  const Real length = s.splat_length.value.x, ratio = s.splat_ratio.value.x;
  if (length == 0 || ratio == 0) return {};
  return {std::numbers::pi_v<Real> * length * length * ratio,
          2 * s.splat_length.error / length + s.splat_ratio.error / ratio};
}

bool area_in_doubt(const Surfel& s) { return in_doubt(s.splat_length) || in_doubt(s.splat_ratio); }

Pull pull(const Surfel& point, const Surfel& s, Real f, Real g) {
  const Vector d = s.place.at - point.place.at, n = unit(s.normal.value);
  const Real h = dot(n, d), r = norm(d), moved = s.place.error + point.place.error;
  const Real h_error = r * s.normal.error + moved;
  const Real x = r * r / (2 * f * f) + h * h / (2 * g * g);
  const Area a = area(s);
  Pull result{.shift = h * n, .shift_error = h_error + std::fabs(h) * s.normal.error, .weight = a.value * std::exp(-x)};
  result.weight_error = double_weight_error(x) + a.error + r * moved / (f * f) + std::fabs(h) * h_error / (g * g) +
                        h_error * h_error / (g * g);
  return result;
}

}  // namespace

Estimate faired(const Surfel& point, std::span<const Surfel> neighbors, Real f, Real g) {
  std::vector<Pull> pulls;
  for (const Surfel& s : neighbors) {
    if (in_doubt(s.normal) || area_in_doubt(s)) return open();
    const bool reached = is_finite(s.place.at - point.place.at);
    if (reached && norm(s.normal.value) > 0 && s.splat_length.value.x > 0) pulls.push_back(pull(point, s, f, g));
  }
  Estimate result{.value = point.place.at, .error = point.place.error};
  if (pulls.empty()) return result;
  if (area_in_doubt(point)) return open();
  const Area own = area(point);
  pulls.push_back({.shift = {}, .weight = own.value, .weight_error = own.error});
  Real total = 0, error = 0;
  Vector sum;
  for (const Pull& p : pulls) total += p.weight, sum = sum + p.weight * p.shift;
  if (!(total > 0)) return result;
  const Vector shift = (1 / total) * sum;
  for (const Pull& p : pulls)
    error += p.weight * (p.shift_error + std::min<Real>(p.weight_error, 1) * norm(p.shift - shift));
  result.value = result.value + shift;
  result.error += error / total + rounding_of_sum(pulls.size()) * norm(shift) + 2 * kDouble * norm(result.value);
  return result;
}

}  // namespace pointsweep::formulas
