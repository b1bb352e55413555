// SPDX-License-Identifier: MIT
#include "pointsweep/verify/formulas/affine.h"

namespace pointsweep::formulas {
namespace {

constexpr Real kSameScale = 1e-6L;
constexpr Real kSteps = 32;  ///< bound of the relative error of a few float64 operations, in units of kDouble

}  // namespace

Affine::Affine(std::span<const double> rows, double scale, Vector translation) {
  const Real added[] = {translation.x, translation.y, translation.z};
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 4; ++c) {
      const Real scaled = Real{rows[4 * r + c]} * Real{scale}, moved = c == 3 ? added[r] : 0;
      entry_[r][c] = scaled + moved;
      error_[r][c] = scale == 1 && moved == 0 ? 0 : 2 * kDouble * (std::fabs(scaled) + std::fabs(moved));
    }
}

/// An entry of A⁻¹ is a cofactor divided by the determinant. The rounding of both is relative to the magnitudes of the
/// products in them. To first order, an error E of A changes A⁻¹ by -A⁻¹ E A⁻¹; the bound is twice its magnitude.
Affine Affine::inverse() const {
  Affine back;
  const Real determinant = this->determinant();
  Real magnitudes = 0;  // sum of the magnitudes of the products in the determinant
  const auto size = [&](std::size_t r, std::size_t c) { return std::fabs(entry_[r % 3][c % 3]); };
  const auto products = [&](std::size_t r, std::size_t c) {
    return size(r + 1, c + 1) * size(r + 2, c + 2) + size(r + 1, c + 2) * size(r + 2, c + 1);
  };
  for (std::size_t r = 0; r < 3; ++r) magnitudes += size(r, 0) * products(r, 0);
  for (std::size_t c = 0; c < 3; ++c) {
    const Vector row = (1 / determinant) * cofactors(c);
    back.entry_[c] = {row.x, row.y, row.z, 0};
  }
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) {
      Real& error = back.error_[r][c];
      error = kSteps * kDouble * (products(c, r) + std::fabs(back.entry_[r][c]) * magnitudes) / std::fabs(determinant);
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
          error += 2 * std::fabs(back.entry_[r][i]) * error_[i][j] * std::fabs(back.entry_[j][c]);
    }
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) {
      const Real part = back.entry_[r][c] * entry_[c][3];
      back.entry_[r][3] -= part;
      back.error_[r][3] += kSteps * kDouble * std::fabs(part) + back.error_[r][c] * std::fabs(entry_[c][3]) +
                           std::fabs(back.entry_[r][c]) * error_[c][3];
    }
  return back;
}

Place Affine::moved(const Place& p) const {
  if (!is_finite(p.at)) return p;
  const Real at[] = {p.at.x, p.at.y, p.at.z, 1};
  Real sum[3] = {}, error[3] = {};
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 4; ++c) {
      const Real part = entry_[r][c] * at[c];
      sum[r] += part;
      error[r] += 4 * kDouble * std::fabs(part) + error_[r][c] * std::fabs(at[c]);
      if (c < 3) error[r] += std::fabs(entry_[r][c]) * p.error;
    }
  return {{sum[0], sum[1], sum[2]}, norm({error[0], error[1], error[2]})};
}

/// The error of the result is a length. An error e of the vector changes its image, scaled back to the length of the
/// vector, by at most 2 e times the condition number of the map; the rounding of the map's numbers counts as such an
/// error.
Estimate Affine::of_same_length(Vector directed, const Estimate& before) const {
  Estimate after = before;
  const Real size = norm(directed), length = norm(before.value);
  if (size > 0) after.value = (length / size) * directed;
  Real own = 0, back = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    own += dot(column(c), column(c));
    back += dot(cofactors(c), cofactors(c));
  }
  const Real condition = std::sqrt(own * back) / std::fabs(determinant());
  after.error = 2 * condition * (before.error + 2 * condition * kSteps * kDouble * length) + kSingle * length;
  return after;
}

Estimate Affine::tangent(const Estimate& v) const {
  const Vector& at = v.value;
  return of_same_length(at.x * column(0) + at.y * column(1) + at.z * column(2), v);
}

Estimate Affine::normal(const Estimate& n) const {
  const Vector& at = n.value;
  const Real side = determinant() < 0 ? -1 : 1;
  return of_same_length(side * (at.x * cofactors(0) + at.y * cofactors(1) + at.z * cofactors(2)), n);
}

Real Affine::scale() const {
  const Real scale = std::sqrt((dot(column(0), column(0)) + dot(column(1), column(1)) + dot(column(2), column(2))) / 3);
  return std::fabs(scale - 1) <= kSameScale ? 1 : scale;
}

}  // namespace pointsweep::formulas
