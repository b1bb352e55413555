// SPDX-License-Identifier: MIT
#include "pointsweep/operators/surface/trajectory.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numeric>
#include <optional>

#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

/// Returns the first four numbers of a line; nullopt if the line does not begin with four numbers.
std::optional<std::array<double, 4>> numbers_of_line(std::string_view line) {
  constexpr std::string_view kSeparators = ",;\t \r";
  std::array<double, 4> numbers;
  std::size_t at = 0;
  for (double& number : numbers) {
    at = line.find_first_not_of(kSeparators, at);
    if (at == std::string_view::npos) return {};
    const std::size_t end = std::min(line.find_first_of(kSeparators, at), line.size());
    const auto [stop, error] = std::from_chars(line.data() + at, line.data() + end, number);
    if (error != std::errc() || stop != line.data() + end || !std::isfinite(number)) return {};
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

}  // namespace pointsweep
