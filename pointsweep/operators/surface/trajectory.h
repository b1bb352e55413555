// SPDX-License-Identifier: MIT
/// The positions of a sensor over time.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/geometry.h"

namespace pointsweep {

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

}  // namespace pointsweep
