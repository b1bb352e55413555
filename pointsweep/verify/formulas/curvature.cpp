// SPDX-License-Identifier: MIT
/// Principal curvatures: Equation 2 of the paper, and the curvatures that follow from variances of normals.
#include <vector>

#include "pointsweep/verify/formulas/surface.h"
#include "pointsweep/verify/formulas/weighted_neighbors.h"

namespace pointsweep::formulas {
namespace {

struct Seen {
  Vector u;      ///< unit normal
  Real u_error;  ///< error of u, whose sign is arbitrary
  Vector d;      ///< p_j - p̄
  Real d_error;
};

bool may_have_normal(const Estimate& n) { return n.is_open() || norm(n.value) > 0; }

std::vector<Seen> seen_from(const Place& p, std::span<const Place> neighbors, std::span<const Estimate> normals) {
  std::vector<Seen> seen;
  Vector mean;
  Real mean_error = 0;
  for (std::size_t j = 0; j < neighbors.size(); ++j) {
    if (!may_have_normal(normals[j])) continue;
    seen.push_back({unit(normals[j].value), std::min<Real>(normals[j].error + 4 * kDouble, 2), neighbors[j].at - p.at,
                    neighbors[j].error});
    mean = mean + seen.back().d;
    mean_error += neighbors[j].error;
  }
  const auto count = static_cast<Real>(seen.size());
  for (Seen& s : seen) s.d = s.d - (1 / count) * mean, s.d_error += mean_error / count;
  return seen;
}

/// Returns the spectrum of S (curvature() in surface.h).
Spectrum spectrum_of_normals(const std::vector<Seen>& seen) {
  const auto count = static_cast<Real>(seen.size());
  Matrix m;
  for (const Seen& s : seen) m.add_outer_product(1 / count, s.u);
  return spectrum_of(m, [&](Vector a, Vector b) {
    Real sum = 0;
    for (const Seen& s : seen) sum += s.u_error * (std::fabs(dot(a, s.u)) + std::fabs(dot(b, s.u)) + s.u_error);
    return sum / count + rounding_of_sum(seen.size());
  });
}

/// Returns the range of √μ for an eigenvalue μ. The roots are singular values of the matrix of all u_j / √m, which move
/// by at most the Frobenius norm of the error of this matrix (Weyl).
Range root_of(Real eigenvalue, const std::vector<Seen>& seen) {
  Real sum2 = 0;
  for (const Seen& s : seen) sum2 += s.u_error * s.u_error;
  const Real moved = std::sqrt(sum2 / static_cast<Real>(seen.size()));
  const Range rounded = not_negative(around(eigenvalue, rounding_of_sum(seen.size())));
  return not_negative({std::sqrt(rounded.low) - moved, std::sqrt(rounded.high) + moved});
}

/// The matrix D (curvature() in surface.h) within the tangent plane: variances along directions that may be turned by
/// an angle.
class Spread {
 public:
  /// The rounding error is relative to offsets from p_i, because the operator sums their squares and subtracts means at
  /// the end.
  Spread(const Place& p, std::span<const Place> neighbors, const std::vector<Seen>& seen, Vector t1, Vector t2,
         Real angle)
      : angle_(angle) {
    const auto count = static_cast<Real>(seen.size());
    Real moved = 0, about_p = 0;
    for (const Seen& s : seen) {
      const Real a = dot(s.d, t1), b = dot(s.d, t2), c = norm(s.d);
      one_ += a * a / count, two_ += b * b / count, both_ += a * b / count;
      whole_ += c * c / count, moved += s.d_error * (2 * c + s.d_error) / count;
    }
    for (const Place& q : neighbors) about_p = std::max(about_p, dot(q.at - p.at, q.at - p.at));
    error_ = moved + rounding_of_sum(seen.size()) * about_p;
  }

  Real one() const { return one_; }
  Real two() const { return two_; }
  Real trace() const { return one_ + two_; }
  Real determinant() const { return one_ * two_ - both_ * both_; }
  Real determinant_error() const { return 4 * error_ * trace(); }
  Range first() const { return turned(one_); }
  Range second() const { return turned(two_); }

 private:
  /// Returns the range of tᵀ D t for a direction t that may be turned by the angle: the value changes by at most 2
  /// angle |t'ᵀ D t| for a t' perpendicular to t, plus terms of second order. If the angle is infinite, the range is
  /// that between the eigenvalues of D within the plane.
  Range turned(Real value) const {
    const Real middle = trace() / 2, radius = std::hypot((one_ - two_) / 2, both_);
    const Real angle = std::min<Real>(angle_, 1);
    const Real out_of_plane = std::sqrt(std::max<Real>(0, whole_ - trace()) * value);
    const Real change = 2 * angle * (std::fabs(both_) + out_of_plane) + angle * angle * whole_ + error_;
    Range range = around(value, change);
    if (angle_ >= kInfinity) range = {middle - radius - error_, middle + radius + error_};
    return not_negative(range);
  }

  Real angle_;
  Real one_ = 0, two_ = 0, both_ = 0, whole_ = 0, error_ = 0;
};

/// Fills the scalars that follow from k1 and k2.
void fill_scalars(Curvatures& c, Real k1, Range r1, Real k2, Range r2) {
  const auto rms = [](Real a, Real b) { return std::sqrt((a * a + b * b) / 2); };
  c.k1 = single_scalar(k1, r1);
  c.k2 = single_scalar(k2, r2);
  c.mean = single_scalar((k1 + k2) / 2, {(r1.low + r2.low) / 2, (r1.high + r2.high) / 2});
  c.gaussian = single_scalar(k1 * k2, {r1.low * r2.low, r1.high * r2.high});
  c.rms = single_scalar(rms(k1, k2), {rms(r1.low, r2.low), rms(r1.high, r2.high)});
  c.absolute = single_scalar(k1 + k2, {r1.low + r2.low, r1.high + r2.high});
}

/// Sets the curvatures along t1 and across it. The larger of the two is k1.
void fill_principal(Curvatures& c, Vector n, const Estimate& t1, Real along, Range range_along, Real across,
                    Range range_across) {
  const bool first = along >= across;
  const Range &larger = first ? range_along : range_across, &smaller = first ? range_across : range_along;
  fill_scalars(c, std::max(along, across), {std::max(larger.low, smaller.low), std::max(larger.high, smaller.high)},
               std::min(along, across), {std::min(larger.low, smaller.low), std::min(larger.high, smaller.high)});
  c.k1_direction = single_direction(first ? t1.value : cross(n, t1.value), t1.error);
  c.k1_direction.either_sign = true;
  if (larger.low <= smaller.high) c.k1_direction.error = kInfinity;  // either curvature may be the larger one
}

void fill_weighted(Curvatures& c, const WeightedNeighbors& weighted, std::span<const Estimate> normals) {
  const auto count = static_cast<Real>(normals.size());
  const Spectrum m = equation1(weighted);
  const Real trace = m.value[0] + m.value[1] + m.value[2];
  const Real trace_error = m.value_error[0] + m.value_error[1] + m.value_error[2];
  c.surface_variation = single_scalar(
      m.value[0] / trace, ratio(not_negative(around(m.value[0], m.value_error[0])), around(trace, trace_error)));
  Matrix normal_covariance;
  for (std::size_t j = 0; j < normals.size(); ++j)
    normal_covariance.add_outer_product(weighted.offsets[j].weight / count, unit(normals[j].value));
  const Spectrum s = spectrum_of(normal_covariance, [&](Vector a, Vector b) {
    Real sum = 0;
    for (std::size_t j = 0; j < normals.size(); ++j) {
      const Vector u = unit(normals[j].value);
      const Real along_a = std::fabs(dot(a, u)), along_b = std::fabs(dot(b, u));
      const Real error = std::min<Real>(normals[j].error, 2);
      sum += weighted.offsets[j].weight_error * along_a * along_b +
             weighted.offsets[j].weight * error * (along_a + along_b + error);
    }
    return sum / count + rounding_of_sum(normals.size()) * normal_covariance.trace();
  });
  const Real theta = weighted.theta_of_nearest, exponent = -std::log(theta);
  const auto scaled = [&](std::size_t a) { return theta * std::max<Real>(s.value[a], 0); };
  c.normal_eigenvalues.value = {scaled(0), scaled(1), scaled(2)};
  const Real error =
      s.value_error[0] + s.value_error[1] + s.value_error[2] + s.value[2] * double_weight_error(exponent);
  c.normal_eigenvalues.error = theta * error + kSingle * scaled(2) + 0x1p-149L;
}

Curvatures every_curvature(const Estimate& e) { return {e, e, e, e, e, e, e, e, e}; }

void allow_undefined(Curvatures& c) {
  for (Estimate* e : {&c.k1, &c.k2, &c.k1_direction, &c.mean, &c.gaussian, &c.rms, &c.absolute, &c.surface_variation,
                      &c.normal_eigenvalues})
    e->may_be_undefined = true;
}

}  // namespace

Curvatures curvature(const Place& p, const Estimate& n, std::span<const Place> neighbors,
                     std::span<const Estimate> normals) {
  if (!may_have_normal(n)) return every_curvature(undefined());
  if (in_doubt(n) || std::ranges::any_of(normals, in_doubt)) return every_curvature(open());
  const std::vector<Seen> seen = seen_from(p, neighbors, normals);
  if (seen.size() < 3) return every_curvature(undefined());
  const WeightedNeighbors weighted = weigh(p, neighbors);
  if (!weighted.finite) return every_curvature(undefined());
  const Spectrum s = spectrum_of_normals(seen);
  const Vector normal = unit(n.value);
  const Estimate t1 =
      tangent(normal, s.vector[1], s.vector[0], std::max(s.vector_error[0], s.vector_error[1]) + n.error);
  const Vector t2 = cross(normal, t1.value);
  const Spread spread(p, neighbors, seen, t1.value, t2, t1.error);
  const Real limit = (1e-12L * spread.trace() + rho2(p)) * spread.trace();
  const Real doubt = spread.determinant_error() + 1e-5L * limit;
  if (spread.determinant() + doubt <= limit || !(weighted.farthest > 0)) return every_curvature(undefined());
  Curvatures c;
  fill_principal(
      c, normal, t1, std::sqrt(s.value[1] / spread.one()), ratio(root_of(s.value[1], seen), root(spread.first())),
      std::sqrt(std::max<Real>(s.value[0], 0) / spread.two()), ratio(root_of(s.value[0], seen), root(spread.second())));
  fill_weighted(c, weighted, normals);
  if (spread.determinant() - doubt <= limit) allow_undefined(c);
  return c;
}

}  // namespace pointsweep::formulas
