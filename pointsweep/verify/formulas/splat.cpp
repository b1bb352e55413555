// SPDX-License-Identifier: MIT
/// Elliptical splats (Section 4.3.3 of the paper), with axes from positions or from the curvature, and the
/// feature-preserving smoothing that weighs neighbours by the areas of their splats (Equation 3).
#include <numbers>
#include <vector>

#include "pointsweep/verify/formulas/surface.h"
#include "pointsweep/verify/formulas/weighted_neighbors.h"

namespace pointsweep::formulas {
namespace {

constexpr std::size_t kHeld = 8;
constexpr Real kLeastRatio = 0.125L;

/// Direction and proportion of an ellipse, without its size.
struct Form {
  Estimate major;
  Real ratio = 1;
  Range ratio_range{1, 1};
};

Form form(Estimate major, Real ratio2, Range range2) {
  const auto clamped = [](Real r2) { return std::clamp<Real>(std::sqrt(std::max<Real>(r2, 0)), kLeastRatio, 1); };
  return {major, clamped(ratio2), {clamped(range2.low), clamped(range2.high)}};
}

Form form_of_positions(const WeightedNeighbors& weighted, const Estimate& n) {
  const Spectrum s = equation1(weighted);
  const Estimate major =
      tangent(unit(n.value), s.vector[2], s.vector[1], std::max(s.vector_error[2], s.vector_error[1]) + n.error);
  const Range l1 = not_negative(around(s.value[1], s.value_error[1]));
  const Range l2 = around(s.value[2], s.value_error[2]);
  return form(major, s.value[1] / s.value[2], ratio(l1, l2));
}

Form form_of_curvature(const CurvatureHere& c, const Estimate& n) {
  Estimate major{.value = cross(unit(n.value), unit(c.k1_direction.value)),
                 .error = c.k1_direction.error + n.error,
                 .either_sign = true};
  const Range k1 = not_negative(around(c.k1.value.x, c.k1.error)), k2 = not_negative(around(c.k2.value.x, c.k2.error));
  return form(major, c.k2.value.x / c.k1.value.x, ratio(k2, k1));
}

bool is_zero(const Estimate& e) { return !e.is_open() && norm(e.value) == 0; }

/// q_j (splat() in surface.h), with its range.
struct Reach {
  Real q, low, high;
};

Reach reach(const WeightedOffset& o, Vector n, const Estimate& n_estimate, const Form& f) {
  const Real x = dot(o.d, f.major.value), y = dot(o.d, cross(n, f.major.value)), h = dot(o.d, n), e = f.ratio;
  const auto q = [&](Real ratio) { return std::hypot(x, y / ratio); };
  // Turning the axes by a small angle changes q by |x y| (1/e² - 1) / q times the angle.
  const Real flattest = f.ratio_range.low, angle = std::min<Real>(f.major.error, 1);
  const Real turn = q(e) > 0 ? std::fabs(x * y) * (1 / (flattest * flattest) - 1) / q(e) * angle : 0;
  const Real tilt = n_estimate.error * (std::fabs(h) + n_estimate.error * norm(o.d)) / flattest;
  const Real error = turn + tilt + o.error / flattest + 32 * kDouble * q(e);
  return {q(e), std::max<Real>(0, q(f.ratio_range.high) - error), q(f.ratio_range.low) + error};
}

Real held(std::vector<Real> q) {
  std::ranges::sort(q);
  if (q.size() >= kHeld) return q[kHeld - 1];
  return q.back() * std::sqrt(static_cast<Real>(kHeld) / static_cast<Real>(q.size()));
}

Estimate length_of(const WeightedNeighbors& weighted, const Estimate& n, const Form& f) {
  std::vector<Real> q, low, high;
  for (const WeightedOffset& o : weighted.offsets) {
    if (!(norm(o.d) > 0)) continue;
    const Reach r = reach(o, unit(n.value), n, f);
    if (r.low <= 0) return open();  // x and y of the neighbour may be 0: then it does not count
    q.push_back(r.q), low.push_back(r.low), high.push_back(r.high);
  }
  return single_scalar(held(q), {held(low), held(high)});
}

Splat whole_splat(const Estimate& e) { return {e, e, e}; }

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

Splat splat(const Place& p, const Estimate& n, std::span<const Place> neighbors, const CurvatureHere* curvature) {
  if (is_zero(n)) return whole_splat(undefined());
  if (n.is_open() || n.may_be_undefined) return whole_splat(open());
  const WeightedNeighbors weighted = weigh(p, neighbors);
  if (!weighted.finite) return whole_splat(undefined());
  if (!(weighted.farthest > 0)) return whole_splat(undefined());
  // It is open whether a neighbour that may coincide with p_i counts.
  const bool unsure = std::ranges::any_of(weighted.offsets,
                                          [](const WeightedOffset& o) { return o.error > 0 && norm(o.d) <= o.error; });
  if (unsure) return whole_splat(open());
  const bool curved = curvature != nullptr && !is_zero(curvature->k1_direction) && !is_zero(curvature->k1);
  if (curved && (curvature->k1.may_be_undefined || curvature->k1.error >= curvature->k1.value.x))
    return whole_splat(open());
  const Form f = curved ? form_of_curvature(*curvature, n) : form_of_positions(weighted, n);
  Splat result{.axis = single_direction(f.major.value, f.major.error),
               .length = length_of(weighted, n, f),
               .ratio = single_scalar(f.ratio, f.ratio_range)};
  result.axis.either_sign = true;
  return result;
}

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
