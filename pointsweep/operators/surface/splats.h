// SPDX-License-Identifier: MIT
/// Elliptical splats: disks that cover the surface together (paper Section 4.3.3).
#pragma once

#include <array>
#include <span>
#include <string>

#include "pointsweep/operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/points/degenerate_points.h"

namespace pointsweep {

/// The ellipse around p_i in the tangent plane of n_i.
///   positions: major axis = eigenvector of the largest eigenvalue λ2 of M_i (normals.h), brought into the plane as
///   Curvature (curvature.h) does with e1, with the eigenvector of λ1 in the place of e0; ratio √(λ1/λ2).
///   curvature: major axis = direction of k2; ratio √(k2/k1), with which the surface is equally far from the plane at
///   the ends of both axes. If k1_direction or k1 is 0, the ellipse is that of positions.
/// Ratios are at least 1/8.
///
/// The ellipse grows until it holds eight neighbours, each measured in the ellipse's own metric. Why eight: an ellipse
/// that holds m points of a surface of even density has area m / density, and random ellipses of that area leave a
/// fraction e^-m of the surface uncovered, 0.03 % for eight; the measured fractions are 0.00 % to 0.08 %
/// (docs/paper.md). For points on a square grid the circles are twice as wide as necessary. Holding all of N_i instead
/// would make splats grow with k. Neighbours on p_i, or on the normal line through p_i, do not count. With x and y
/// along the axes, the length is the eighth smallest √(x² + (y/ratio)²); with m < 8 neighbours, it is √(8/m) times the
/// largest. θ of M_i is in single precision, all else in double.
///
/// Makes "splat_axis" (unit), "splat_length" (major semi-axis) and "splat_ratio" (minor over major, in [1/8, 1]). All
/// are 0, and the point counted as degenerate, where the point has no normal or no neighbour that counts, or where an
/// offset overflows or is not finite.
class Splats : public LocalOperator {
 public:
  explicit Splats(const SplatsOptions& options = {});
  std::string name() const override { return "splats"; }
  Contract contract() const override;
  void apply(const Neighborhoods& in, Columns& out) const override;
  /// If `axes` is automatic, returns an operator that uses curvature if an earlier stage makes k1_direction, else
  /// positions. Otherwise returns null.
  std::shared_ptr<const LocalOperator> bound(const Schema& input, std::span<const Attribute> made) const override;

 private:
  SplatsOptions options_;
};

Attribute splat_axis_attribute();
Attribute splat_length_attribute();
Attribute splat_ratio_attribute();

/// The columns that Splats makes, each as long as the batch.
struct SplatColumns {
  std::span<std::array<float, 3>> axis;  ///< unit vector along the major semi-axis
  std::span<float> length;               ///< length of the major semi-axis, in units of the cloud
  std::span<float> ratio;                ///< minor over major semi-axis, in [1/8, 1]
};

/// Fits the splats of all points of the batch, whose first attribute read is the normal. If `along_ridges`, the next
/// three attributes are the direction of k1, k1 and k2, which shape the ellipses of points that have curvatures. M_i
/// (Equation 1) shapes all other ellipses. Points without a splat get 0 and are marked as degenerate. The bits depend
/// only on a point's neighbourhood: not on the instruction set or the batch.
void fit_splats(const Neighborhoods& in, bool along_ridges, const SplatColumns& out, DegeneratePoints& degenerate);

}  // namespace pointsweep
