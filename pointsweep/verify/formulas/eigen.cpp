// SPDX-License-Identifier: MIT
#include "pointsweep/verify/formulas/eigen.h"

#include <algorithm>
#include <utility>

namespace pointsweep::formulas {
namespace {

constexpr int kMostSweeps = 50;  ///< most passes over all off-diagonal entries; usually five or six suffice

using Entries = std::array<std::array<Real, 3>, 3>;

/// Rotates `a` in the plane of the axes p and q so that its entry (p, q) becomes 0, and `axes` by the same rotation.
void rotate(Entries& a, Entries& axes, std::size_t p, std::size_t q) {
  if (a[p][q] == 0) return;
  const Real cotangent = (a[q][q] - a[p][p]) / (2 * a[p][q]);
  const Real t = (cotangent >= 0 ? 1 : -1) / (std::fabs(cotangent) + std::hypot(cotangent, Real{1}));
  const Real c = 1 / std::hypot(t, Real{1}), s = t * c;
  for (std::size_t k = 0; k < 3; ++k) {
    const Real kp = a[k][p], kq = a[k][q];
    a[k][p] = c * kp - s * kq, a[k][q] = s * kp + c * kq;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const Real pk = a[p][k], qk = a[q][k];
    a[p][k] = c * pk - s * qk, a[q][k] = s * pk + c * qk;
    const Real vp = axes[k][p], vq = axes[k][q];
    axes[k][p] = c * vp - s * vq, axes[k][q] = s * vp + c * vq;
  }
  a[p][q] = a[q][p] = 0;
}

}  // namespace

Eigen eigen_of(const Matrix& symmetric) {
  Entries a = symmetric.entry, axes{};
  for (std::size_t i = 0; i < 3; ++i) axes[i][i] = 1;
  for (int sweep = 0; sweep < kMostSweeps && (a[0][1] != 0 || a[0][2] != 0 || a[1][2] != 0); ++sweep)
    for (const auto& [p, q] : {std::pair{0, 1}, std::pair{0, 2}, std::pair{1, 2}})
      rotate(a, axes, static_cast<std::size_t>(p), static_cast<std::size_t>(q));
  std::array<std::size_t, 3> order{0, 1, 2};
  std::ranges::sort(order, [&](std::size_t i, std::size_t j) { return a[i][i] < a[j][j]; });
  Eigen result;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t k = order[i];
    result.value[i] = a[k][k];
    result.vector[i] = unit({axes[0][k], axes[1][k], axes[2][k]});
  }
  return result;
}

}  // namespace pointsweep::formulas
