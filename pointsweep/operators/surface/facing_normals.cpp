// SPDX-License-Identifier: MIT
#include "pointsweep/operators/surface/facing_normals.h"

#include <array>
#include <cmath>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/operators/expressions/single_value.h"
#include "pointsweep/points/text_file.h"

namespace pointsweep {
FacingNormals::FacingNormals(std::string file, std::string checksum)
    : file_(std::move(file)),
      checksum_(std::move(checksum)),
      time_(scalar("gps_time", Type::f64, "s", "time at which the point was measured")) {
  const std::string text = read_text_file(file_, "lines of time, x, y, z"), found = checksum_of_text(text);
  if (!checksum_.empty() && checksum_ != found)
    fail("{}: is not the trajectory that the run read: its checksum is {}, not {}; give that, or leave checksum out.",
         file_, found, checksum_);
  checksum_ = found;
  trajectory_ = std::make_shared<const Trajectory>(text, file_);
}

Contract FacingNormals::contract() const {
  return {.reads = {normal_attribute(), time_}, .makes = {normal_attribute()}, .default_k = 0};
}

std::shared_ptr<const LocalOperator> FacingNormals::bound(const Schema& input, std::span<const Attribute> made) const {
  const std::optional<Attribute> found = single_value("gps_time", input, made);
  if (!found) return nullptr;
  if (found->type != Type::f64)
    fail_usage("orient: gps_time as it was made before is no float64; make it with as=float64.");
  auto bound = std::make_shared<FacingNormals>(*this);
  bound->time_ = *found;
  return bound;
}

/// Computes 0 - n, which is never -0, instead of -n.
void FacingNormals::apply(const Neighborhoods& in, Columns& out) const {
  const auto normals = out.column<std::array<float, 3>>(0);
  for (std::size_t i = 0; i < in.size(); ++i) {
    const auto n = normals[i] = in.value<std::array<float, 3>>(0, i);
    const double time = in.value<double>(1, i);
    if (std::isnan(time) || !is_finite(in.position(i))) continue;
    if (time < trajectory_->first_time() - kMostSeconds || time > trajectory_->last_time() + kMostSeconds)
      fail(
          "{}: is a trajectory from {} to {}, and a point was measured at {}; give the trajectory of this survey, with "
          "times of the same system.",
          file_, trajectory_->first_time(), trajectory_->last_time(), time);
    if (dot(in.vector(0, i), trajectory_->at(time) - in.position(i)) < 0)
      normals[i] = {0.0f - n[0], 0.0f - n[1], 0.0f - n[2]};
  }
}

}  // namespace pointsweep
