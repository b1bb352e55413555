// SPDX-License-Identifier: MIT
/// Normals that face a moving sensor.
#pragma once

#include <memory>
#include <string>

#include "pointsweep/operator.h"
#include "pointsweep/operators/surface/trajectory.h"

namespace pointsweep {

/// Makes normal: the existing normal, turned so that n . (s - p) >= 0, with s the place of the sensor at the gps_time
/// of the point.
class FacingNormals final : public LocalOperator {
 public:
  /// A time farther than this outside of the trajectory belongs to another clock or survey.
  static constexpr double kMostSeconds = 1;

  /// Reads the file. Throws Error if it is no trajectory, or if `checksum` is not empty and differs from its checksum.
  FacingNormals(std::string file, std::string checksum);

  std::string name() const override { return "orient"; }
  Contract contract() const override;
  std::shared_ptr<const LocalOperator> bound(const Schema& input, std::span<const Attribute> made) const override;
  /// Throws Error for a time that is more than kMostSeconds outside of the trajectory.
  void apply(const Neighborhoods& in, Columns& out) const override;
  const std::string& checksum() const { return checksum_; }

 private:
  std::string file_, checksum_;
  std::shared_ptr<const Trajectory> trajectory_;
  Attribute time_;
};

}  // namespace pointsweep
