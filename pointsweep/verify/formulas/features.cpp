// SPDX-License-Identifier: MIT
/// Features of the shape of a neighbourhood: from the eigenvalues and eigenvectors of its covariance, its moments along
/// the eigenvectors, and its heights.
#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "pointsweep/verify/formulas/eigen.h"
#include "pointsweep/verify/formulas/surface.h"

namespace pointsweep::formulas {
namespace {

constexpr Real kLargestSingle = std::numeric_limits<float>::max();
constexpr Real kLogarithm = 1e-12L;  ///< relative error of logarithms and of values computed from them
constexpr Real kTooFar = 0x1p1022L;  ///< component of an offset from which the offset may count as not finite

/// The points of P (Features in surface.h), as offsets from p.
struct Cloud {
  std::vector<Vector> offset;
  std::vector<Real> error;  ///< error of each offset, with its rounding
  Vector mean;
  Real reach = 0;    ///< largest length of an offset
  Real extent = 0;   ///< largest component of an offset
  Real moment = 0;   ///< Σ |q - origin|², origin the point of P about which an operator may sum
  Real origin2 = 0;  ///< |origin - p|²

  Cloud(const Place& p, std::span<const Place> neighbors, bool with_point) {
    for (const Place& q : neighbors) offset.push_back(q.at - p.at), error.push_back(p.error + q.error);
    for (const Vector& d : offset) reach = std::max(reach, norm(d)), extent = std::max(extent, largest_component(d));
    if (with_point) offset.push_back({}), error.push_back(0);
    const Vector origin = with_point || offset.empty() ? Vector{} : offset.front();
    origin2 = dot(origin, origin);
    for (std::size_t i = 0; i < offset.size(); ++i) {
      error[i] += 4 * kDouble * (norm(offset[i]) + norm(origin));
      mean = mean + (1 / size()) * offset[i];
      moment += dot(offset[i] - origin, offset[i] - origin);
    }
  }
  Real size() const { return static_cast<Real>(offset.size()); }
  Real rounding() const { return 4 * rounding_of_sum(offset.size()); }
  Real mean_error() const {
    Real sum = 0;
    for (const Real e : error) sum += e;
    return sum / size();
  }
  bool is_one_place() const {
    return std::ranges::all_of(offset, [&](const Vector& d) { return norm(d - offset.front()) == 0; });
  }
};

Spectrum covariance_spectrum(const Cloud& cloud) {
  Matrix m;
  for (const Vector& d : cloud.offset) m.add_outer_product(1 / cloud.size(), d - cloud.mean);
  const Real mean_error = cloud.mean_error();
  return spectrum_of(m, [&](Vector u, Vector v) {
    Real sum = 0;
    for (std::size_t i = 0; i < cloud.offset.size(); ++i) {
      const Vector d = cloud.offset[i] - cloud.mean;
      const Real e = cloud.error[i] + mean_error;
      sum += e * (std::fabs(dot(u, d)) + std::fabs(dot(v, d)) + e);
    }
    return (sum + cloud.rounding() * cloud.moment) / cloud.size();
  });
}

Estimate saturated(Real value, Range range) {
  const auto single = [](Real v) { return std::clamp(v, -kLargestSingle, kLargestSingle); };
  return single_scalar(single(value), {single(range.low), single(range.high)});
}

/// The values λ1 >= λ2 >= λ3, which follow from the eigenvalues by `Lambda`, with their ranges.
struct Lambdas {
  std::array<Real, 3> value{};
  std::array<Range, 3> range{};

  Lambdas(const Spectrum& s, Lambda lambda) {
    Real sum = 0, sum_error = 0;
    for (std::size_t a = 0; a < 3; ++a) sum += std::max<Real>(s.value[a], 0), sum_error += s.value_error[a];
    for (std::size_t a = 0; a < 3; ++a) {
      const Real l = std::max<Real>(s.value[2 - a], 0), error = s.value_error[2 - a];
      value[a] = l, range[a] = not_negative(around(s.value[2 - a], error));
      if (lambda == Lambda::root) {
        value[a] = std::sqrt(l), range[a] = root(range[a]);
      } else if (lambda == Lambda::normalized) {
        value[a] = l / sum;
        range[a] = {range[a].low / (sum + sum_error), range[a].high / std::max<Real>(sum - sum_error, 0)};
      }
    }
  }
  Real sum() const { return value[0] + value[1] + value[2]; }
};

Real entropy_term(Real v) { return v > 0 ? -v * std::log(v) : 0; }

/// Returns the range of -v ln v, whose only maximum is at 1/e.
Range entropy_range(Range v) {
  const Real a = entropy_term(v.low), b = entropy_term(v.high), top = std::exp(Real{-1});
  const bool over_the_top = v.low < top && v.high > top;
  return {std::min(a, b), over_the_top ? top : std::max(a, b)};
}

Estimate entropy(const Lambdas& l, const Cloud& cloud, Lambda lambda) {
  const int power = lambda == Lambda::raw ? 2 : lambda == Lambda::root ? 1 : 0;
  Real value = 0, rounding = 0;
  Range range;
  for (std::size_t a = 0; a < 3; ++a) {
    const Range term = entropy_range(l.range[a]);
    value += entropy_term(l.value[a]), range.low += term.low, range.high += term.high;
    // The bound also covers operators that compute the logarithm of the unit of length separately.
    rounding += std::fabs(entropy_term(l.value[a])) + l.value[a] * power * (2 * std::fabs(std::log(cloud.extent)) + 2);
  }
  rounding *= kLogarithm;
  return saturated(value, {range.low - rounding, range.high + rounding});
}

void set_shapes(Features& f, const Lambdas& l, const Cloud& cloud, Lambda lambda) {
  const auto& [a, b, c] = l.range;
  const Real v1 = l.value[0], v2 = l.value[1], v3 = l.value[2];
  const auto share = [](Real part, Real whole) { return std::clamp<Real>(part / whole, 0, 1); };
  const auto shape = [](Real value, Real low, Real high) {
    return saturated(value, {std::min(low, value) - 8 * kDouble, std::max(high, value) + 8 * kDouble});
  };
  f.linearity = shape((v1 - v2) / v1, 1 - share(b.high, a.low), 1 - share(b.low, a.high));
  f.planarity = shape((v2 - v3) / v1, share(b.low - c.high, a.high), share(b.high - c.low, a.low));
  f.sphericity = shape(v3 / v1, share(c.low, a.high), share(c.high, a.low));
  f.anisotropy = shape((v1 - v3) / v1, 1 - share(c.high, a.low), 1 - share(c.low, a.high));
  f.surface_variation = shape(v3 / l.sum(), c.low / (c.low + a.high + b.high), share(c.high, c.high + a.low + b.low));
  f.omnivariance = saturated(std::cbrt(v1) * std::cbrt(v2) * std::cbrt(v3),
                             {std::cbrt(a.low) * std::cbrt(b.low) * std::cbrt(c.low) * (1 - kLogarithm),
                              std::cbrt(a.high) * std::cbrt(b.high) * std::cbrt(c.high) * (1 + kLogarithm)});
  const Real slack = 8 * kDouble * l.sum();
  f.eigenvalue_sum = saturated(l.sum(), {a.low + b.low + c.low - slack, a.high + b.high + c.high + slack});
  f.eigenentropy = entropy(l, cloud, lambda);
}

Estimate verticality(const Place& p, const Spectrum& s) {
  const PlaneDoubt no_plane = no_plane_in(s, p, 1);
  if (no_plane.sure) return undefined();
  if (!(s.vector_error[0] < kInfinity)) return open();
  const Real value = 1 - std::fabs(s.vector[0].z), error = s.vector_error[0] + 64 * kDouble;
  Estimate result = single_scalar(value, {std::max<Real>(value - error, 0), std::min<Real>(value + error, 1)});
  result.may_be_undefined = no_plane.possible;
  return result;
}

/// The first and second moments about p along an axis. `turn` bounds the angular error of the axis, in radians; if it
/// is infinite, both moments are open.
struct AxisMoments {
  Estimate first, second;

  AxisMoments(const Cloud& cloud, Vector axis, Real turn) : first(open()), second(open()) {
    if (!(turn < kInfinity)) return;
    Vector sum, along_axis;  // Σ d and Σ d (d · e)
    Real lengths = 0, squares = 0, all = 0, moved1 = 0, moved2 = 0;
    for (std::size_t i = 0; i < cloud.offset.size(); ++i) {
      const Vector d = cloud.offset[i];
      const Real along = dot(d, axis), e = cloud.error[i];
      sum = sum + d, along_axis = along_axis + along * d;
      lengths += norm(d), squares += along * along, all += dot(d, d);
      moved1 += e, moved2 += e * (2 * std::fabs(along) + e);
    }
    const Real scale = all + cloud.size() * cloud.origin2, value = std::fabs(dot(sum, axis));
    const Real error1 = norm(sum) * turn + moved1 + cloud.rounding() * (lengths + std::sqrt(cloud.size() * scale));
    const Real error2 = 2 * norm(along_axis) * turn + all * turn * turn + moved2 + cloud.rounding() * scale;
    first = saturated(value, {std::max<Real>(value - error1, 0), value + error1});
    second = saturated(squares, {std::max<Real>(squares - error2, 0), squares + error2});
  }
};

Estimate height_range(const Cloud& cloud) {
  Real low = kInfinity, high = -kInfinity, error = 0;
  for (std::size_t i = 0; i < cloud.offset.size(); ++i) {
    low = std::min(low, cloud.offset[i].z), high = std::max(high, cloud.offset[i].z);
    error = std::max(error, cloud.error[i]);
  }
  return saturated(high - low, around(high - low, 2 * error));
}

Features all_open() {
  const Estimate o = open();
  return {o, o, o, o, o, o, o, o, o, o, o, o, o, o, o};
}

}  // namespace

Features features(const Place& p, std::span<const Place> neighbors, Lambda lambda, bool with_point) {
  const Cloud cloud(p, neighbors, with_point);
  Features f;
  const bool finite = std::ranges::all_of(cloud.offset, fits_double);
  if (finite && cloud.extent >= kTooFar) f = all_open();
  f.number_of_neighbors = exactly(cloud.size());
  if (!finite || cloud.extent >= kTooFar || cloud.offset.empty()) return f;
  f.height_range = height_range(cloud);
  const bool may_have_moved = std::ranges::any_of(neighbors, [](const Place& q) { return q.error > 0; });
  if (cloud.is_one_place() && !may_have_moved && p.error == 0) return f;
  const Spectrum s = covariance_spectrum(cloud);
  if (s.value[2] <= s.value_error[2]) {
    const Estimate height = f.height_range, number = f.number_of_neighbors;
    f = all_open(), f.height_range = height, f.number_of_neighbors = number;
    return f;
  }
  set_shapes(f, Lambdas(s, lambda), cloud, lambda);
  f.verticality = verticality(p, s);
  const AxisMoments axis1(cloud, s.vector[2], s.vector_error[2]), axis2(cloud, s.vector[1], s.vector_error[1]);
  f.moment1_axis1 = axis1.first, f.moment2_axis1 = axis1.second;
  f.moment1_axis2 = axis2.first, f.moment2_axis2 = axis2.second;
  return f;
}

}  // namespace pointsweep::formulas
