// SPDX-License-Identifier: MIT
/// Normals that face a sensor on its way.
#pragma once

#include <memory>
#include <string>

#include "pointsweep/operator.h"
#include "pointsweep/operators/surface/trajectory.h"

namespace pointsweep {

/// Makes normal: the one there is, turned so that n . (s - p) >= 0, s where the sensor was at the gps_time of the
/// point.
class FacingNormals final : public LocalOperator {
 public:
  /// A time that lies so far outside of a trajectory is of another system or survey.
  static constexpr double kMostSeconds = 1;

  /// Reads the file. Throws Error, also where its content has another checksum than the one given, if that is not
  /// empty.
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
