// SPDX-License-Identifier: MIT
#include "pointsweep/operators/declare/least_eigenentropy.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pointsweep/fail.h"
#include "pointsweep/math/batch.h"
#include "pointsweep/math/exp.h"
#include "pointsweep/math/symmetric3.h"
#include "pointsweep/operators.h"

namespace pointsweep {
namespace {

constexpr double kSmallest = std::numeric_limits<double>::min();

/// Returns -e ln e, 0 at 0. Rounding may make the eigenvalue of a plane or a line slightly negative.
double entropy_of(double e) { return e >= kSmallest ? -(e * natural_logarithm(e)) : 0; }

/// Returns the eigenentropy; infinite if the points have no extent.
double eigenentropy(const Eigen3& eigen) {
  const double sum = (eigen.value[0] + eigen.value[1]) + eigen.value[2];
  if (!(sum >= kSmallest)) return std::numeric_limits<double>::infinity();
  return (entropy_of(eigen.value[0] / sum) + entropy_of(eigen.value[1] / sum)) + entropy_of(eigen.value[2] / sum);
}

/// Returns the power of two that scales the farthest neighbour to about 1, so that no extent of a cloud under- or
/// overflows. Returns 0 if there is no such power.
double scale_of(Vec3 farthest) {
  const double largest = std::max({std::abs(farthest.x), std::abs(farthest.y), std::abs(farthest.z)});
  if (!(largest >= kSmallest && largest < 0x1p1022)) return 0;
  return reciprocal_of_power(power_of_two_below(largest));
}

/// Computes the covariances of p_i and its k nearest neighbours about their mean, for k from `least` to in.count(i).
void covariances(const Neighborhoods& in, std::size_t i, std::size_t least, double scale,
                 std::vector<Symmetric3>& out) {
  Symmetric3 squares;
  Vec3 sum;
  out.clear();
  for (std::size_t j = 0; j < in.count(i); ++j) {
    const Vec3 o = scale * in.offset(i, j);
    add_outer_product(squares, 1, o);
    sum = sum + o;
    if (j + 1 < least) continue;
    const double points = static_cast<double>(j + 2);  // includes p_i, whose offset is 0
    Symmetric3 m = squares;
    add_outer_product(m, -1 / points, sum);
    out.push_back(m);
  }
}

}  // namespace

LeastEigenentropy::LeastEigenentropy(std::size_t least) : least_(least) {
  if (least < 3)
    fail_usage("The least k to choose from is {}, but fewer than 3 neighbours never span a volume.", least);
}

std::string LeastEigenentropy::meaning() const {
  return fmt::format("the first {} or more with the least eigenentropy", least_);
}

void LeastEigenentropy::choose(const Neighborhoods& in, std::span<std::uint32_t> counts) const {
  std::vector<Symmetric3> matrices;
  std::vector<Eigen3> eigen;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const std::size_t count = in.count(i);
    counts[i] = static_cast<std::uint32_t>(count);
    const double scale = count > least_ ? scale_of(in.offset(i, count - 1)) : 0;
    if (scale == 0) continue;
    covariances(in, i, least_, scale, matrices);
    eigen.resize(matrices.size());
    batch_eigen_symmetric3(matrices, eigen);
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t m = 0; m < eigen.size(); ++m) {
      const double entropy = eigenentropy(eigen[m]);
      if (!(entropy < best)) continue;
      best = entropy;
      counts[i] = static_cast<std::uint32_t>(least_ + m);
    }
  }
}

SharedRule operators::least_eigenentropy(std::size_t least) { return std::make_shared<LeastEigenentropy>(least); }

}  // namespace pointsweep
