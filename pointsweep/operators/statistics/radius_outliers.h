// SPDX-License-Identifier: MIT
/// Radius outliers: points with few neighbours near them (filters.outlier, method radius, of PDAL; RadiusOutlierRemoval
/// of PCL; remove_radius_outlier of Open3D).
#pragma once

#include <string>

#include "pointsweep/operator.h"
#include "pointsweep/operators.h"

namespace pointsweep {

/// Makes outlier, N u8: 1 if fewer than `min_neighbors` of N_i lie within `radius`, inclusive, of the point, at the
/// current positions; else 0. N_i must contain the min_neighbors nearest points, or all within the radius: a k of at
/// least min_neighbors and no smaller radius. Pipelines without such neighbourhoods are refused; C++ code must ensure
/// it.
class RadiusOutliers final : public LocalOperator {
 public:
  /// Throws UsageError for options out of their ranges.
  explicit RadiusOutliers(const RorOptions& options);
  std::string name() const override { return "ror"; }
  Contract contract() const override;
  void apply(const Neighborhoods& in, Columns& out) const override;

 private:
  RorOptions options_;
};

}  // namespace pointsweep
