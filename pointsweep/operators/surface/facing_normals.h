// SPDX-License-Identifier: MIT
/// The trajectory of a moving sensor, and normals that face the sensor where it was when it measured the point.
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
  /// Parses lines of time, x, y, z, separated by commas, semicolons, tabs or blanks. Further columns, blank lines and
  /// lines that begin with # are ignored, and so is the first other line if it does not begin with four finite numbers,
  /// as a line of names. Times may come in any order. Throws an Error that begins with `name` if a later line does not
  /// begin with four finite numbers, if no line does, or if two lines have the same time.
  Trajectory(std::string_view text, const std::string& name);

  double first_time() const { return times_.front(); }
  double last_time() const { return times_.back(); }
  /// Returns the place at `time`, by linear interpolation between the places before and after `time`; the first or last
  /// place if `time` is outside of the trajectory.
  Vec3 at(double time) const;

 private:
  std::vector<double> times_;  ///< ascending
  std::vector<Vec3> places_;
};

/// Makes normal: the existing normal n, negated if n . (s - p) < 0, with s the place of the sensor at the gps_time of
/// the point. Points without a finite position, or with a NaN time, keep their normal.
class FacingNormals final : public LocalOperator {
 public:
  /// Largest distance of a time from the trajectory, in seconds. A time farther outside belongs to another clock or
  /// survey.
  static constexpr double kMostSeconds = 1;

  /// Reads the file. Throws Error if the file cannot be read or is no trajectory, or if `checksum` is not empty and
  /// differs from the checksum of the file.
  FacingNormals(std::string file, std::string checksum);

  std::string name() const override { return "orient"; }
  Contract contract() const override;
  std::shared_ptr<const LocalOperator> bound(const Schema& input, std::span<const Attribute> made) const override;
  /// Throws Error for a point with a finite position whose time is more than kMostSeconds outside of the trajectory.
  void apply(const Neighborhoods& in, Columns& out) const override;
  const std::string& checksum() const { return checksum_; }

 private:
  std::string file_, checksum_;
  std::shared_ptr<const Trajectory> trajectory_;
  Attribute time_;
};

}  // namespace pointsweep
