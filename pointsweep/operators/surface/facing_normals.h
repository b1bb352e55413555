// SPDX-License-Identifier: MIT
/// The trajectory of a moving sensor, and normals that face the sensor.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/operator.h"

namespace pointsweep {

/// The positions of a sensor over time.
class Trajectory {
 public:
  /// Parses lines of time, x, y, z, separated by commas, semicolons, tabs or blanks. Further columns, empty lines,
  /// lines that begin with #, and a first line of names are ignored. Times are distinct, in any order. Throws Error
  /// that begins with `name` and states the invalid line.
  Trajectory(std::string_view text, const std::string& name);

  double first_time() const { return times_.front(); }
  double last_time() const { return times_.back(); }
  /// Returns the place on the straight line between the places before and after `time`; the first or last place if
  /// `time` is outside of the trajectory.
  Vec3 at(double time) const;

 private:
  std::vector<double> times_;  ///< ascending
  std::vector<Vec3> places_;
};

/// Makes normal: the existing normal, turned so that n . (s - p) >= 0, with s the place of the sensor at the gps_time
/// of the point.
class FacingNormals final : public LocalOperator {
 public:
  /// Largest distance of a time from the trajectory, in seconds. A time farther outside belongs to another clock or
  /// survey.
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
