// SPDX-License-Identifier: MIT
/// Features of the shape of a neighbourhood, most of them from the eigenvalues and eigenvectors of its covariance: how
/// much the neighbourhood resembles a line, a plane or a volume.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/points/degenerate_points.h"

namespace pointsweep {

/// The features in the order of the attributes that Features makes. The features up to height_range are float32,
/// number_of_neighbors is u32.
enum class Feature : std::uint8_t {
  linearity,
  planarity,
  sphericity,
  omnivariance,
  anisotropy,
  eigenentropy,
  eigenvalue_sum,
  surface_variation,
  verticality,
  moment1_axis1,
  moment1_axis2,
  moment2_axis1,
  moment2_axis2,
  height_range,
  number_of_neighbors,
};
inline constexpr std::size_t kFeatures = 15;

/// The set P of a point contains its neighbours and, by default, p_i itself; n = |P|, p̄ the mean of P.
///   Σ = 1/n Σ_{p in P} (p - p̄)(p - p̄)^T, eigenvalues l1 >= l2 >= l3 >= 0, unit eigenvectors e1, e2, e3.
/// λ are l (raw, length²), √l (root, length) or l / (l1 + l2 + l3) (normalized).
///
/// | attribute (N f32)   | formula                         | unit of raw / root / normalized |
/// | linearity           | (λ1 - λ2) / λ1                  | 1 |
/// | planarity           | (λ2 - λ3) / λ1                  | 1 |
/// | sphericity          | λ3 / λ1                         | 1 |
/// | omnivariance        | ∛(λ1 λ2 λ3)                     | length² / length / 1 |
/// | anisotropy          | (λ1 - λ3) / λ1                  | 1 |
/// | eigenentropy        | -Σ λ ln λ, 0 ln 0 = 0           | length² / length / 1; ln of λ in that unit |
/// | eigenvalue_sum      | λ1 + λ2 + λ3                    | length² / length / 1 |
/// | surface_variation   | λ3 / (λ1 + λ2 + λ3)             | 1, [0, 1/3] |
/// | verticality         | 1 - |e3 · z|                    | 1, [0, 1] |
/// | moment1_axis1, 2    | |Σ_{p in P} (p - p_i) · e_a|    | length; a = 1 or 2, as in axis1 and axis2 |
/// | moment2_axis1, 2    | Σ_{p in P} ((p - p_i) · e_a)²   | length² |
/// | height_range        | max z - min z over P            | length |
/// | number_of_neighbors | n (N u32)                       | 1 |
///
/// Sources: M. Weinmann et al., ISPRS Journal 105 (2015); T. Hackel, J. D. Wegner, K. Schindler, "Fast semantic
/// segmentation of 3D point clouds with strongly varying density" (2016), for moments and verticality. Their moments
/// have the sign of an eigenvector, which is arbitrary, and are absolute here. CloudCompare's "1st order moment" is
/// moment1_axis2² / moment2_axis2.
///
/// If P has at most one point, all points of P coincide, or an offset overflows or is not finite, all attributes but
/// number_of_neighbors are 0. verticality is 0 if P lies on a line to rounding: l2 <= 1e-12 l1 + ρ², ρ as in Normals.
/// The point counts as degenerate if Features makes an attribute, other than height_range, that is 0 for one of these
/// reasons. If two eigenvalues are equal, their axes are an arbitrary orthogonal pair.
///
/// Everything is in double and rounded to float32 at the end. Sums are relative to a point of P; the error of an
/// eigenvalue is some n 2^-52 of the largest eigenvalue.
class Features final : public LocalOperator {
 public:
  /// Throws UsageError for an unknown or repeated name.
  explicit Features(FeaturesOptions options = {});
  std::string name() const override { return "features"; }
  Contract contract() const override;
  void apply(const Neighborhoods& in, Columns& out) const override;

 private:
  FeaturesOptions options_;
  std::vector<Feature> made_;
};

/// The features to compute, and the columns that take them.
struct FeatureColumns {
  std::array<std::span<float>, kFeatures - 1> numbers;  ///< by Feature: as long as the batch; empty if not wanted
  EigenvalueScale eigenvalues = EigenvalueScale::raw;
  bool with_point = true;            ///< true if p_i itself is one of the points
  bool marks_without_extent = true;  ///< true to mark points whose P has no extent as degenerate
  bool marks_lines = true;           ///< true to mark points whose P lies on a line or has no extent

  std::span<float> operator[](Feature f) const { return numbers[static_cast<std::size_t>(f)]; }
};

/// Computes the features of all points of the batch, except number_of_neighbors. Points without a result get 0; the
/// flags of `out` choose which of them are marked as degenerate. The bits depend only on a point's neighbourhood: not
/// on the instruction set or the batch.
void features(const Neighborhoods& in, const FeatureColumns& out, DegeneratePoints& degenerate);

}  // namespace pointsweep
