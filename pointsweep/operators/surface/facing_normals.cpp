// SPDX-License-Identifier: MIT
#include "pointsweep/operators/surface/facing_normals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/number_from.h"
#include "pointsweep/operators/expressions/named_values.h"
#include "pointsweep/operators/surface/normals.h"
#include "pointsweep/points/text_file.h"

namespace pointsweep {
namespace {

/// Returns the first four numbers of a line; nullopt if the line does not begin with four finite numbers.
std::optional<std::array<double, 4>> numbers_of_line(std::string_view line) {
  constexpr std::string_view kSeparators = ",;\t \r";
  std::array<double, 4> numbers;
  std::size_t at = 0;
  for (double& number : numbers) {
    at = line.find_first_not_of(kSeparators, at);
    if (at == std::string_view::npos) return {};
    const std::size_t end = std::min(line.find_first_of(kSeparators, at), line.size());
    number = number_from<double>(line.substr(at, end - at)).value_or(std::numeric_limits<double>::quiet_NaN());
    if (!std::isfinite(number)) return {};
    at = end;
  }
  return numbers;
}

}  // namespace

Trajectory::Trajectory(std::string_view text, const std::string& name) {
  std::vector<std::array<double, 4>> rows;
  std::size_t line_number = 0;
  bool may_be_names = true;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = text.substr(at, end - at);
    at = end + 1, ++line_number;
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string_view::npos || line[first] == '#') continue;
    const auto numbers = numbers_of_line(line);
    if (!numbers && !may_be_names)
      fail("{}, line {}: is not a time and three coordinates; write time, x, y, z.", name, line_number);
    if (numbers) rows.push_back(*numbers);
    may_be_names = false;
  }
  if (rows.empty()) fail("{}: holds no time with three coordinates; write lines of time, x, y, z.", name);
  std::ranges::sort(rows);
  for (const auto& [time, x, y, z] : rows) {
    if (!times_.empty() && times_.back() == time) fail("{}: has the time {} twice; remove one of them.", name, time);
    times_.push_back(time);
    places_.push_back({x, y, z});
  }
}

Vec3 Trajectory::at(double time) const {
  const auto after = static_cast<std::size_t>(std::ranges::lower_bound(times_, time) - times_.begin());
  if (after == times_.size()) return places_.back();
  if (after == 0 || times_[after] == time) return places_[after];
  const double share = (time - times_[after - 1]) / (times_[after] - times_[after - 1]);
  return places_[after - 1] + share * (places_[after] - places_[after - 1]);
}

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
    if (dot(in.vector(0, i), trajectory_->at(time) - in.position(i)) < 0) normals[i] = flipped(n);
  }
}

}  // namespace pointsweep
