// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/memory/radius_estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "pointsweep/cancellation.h"
#include "pointsweep/pipeline/language/registry.h"

namespace pointsweep {
namespace {

constexpr std::size_t kQueries = 512;
constexpr std::size_t kNearest = 8;  ///< of the sample, from whose distance a density follows

/// ns for each neighbour and use of its list, measured with `script/bench radius` at about 1,000 neighbours.
constexpr double kSearchCost = 20, kOtherCost = 10;

/// Points of the sample within the radius of sample point `q`, as the number that they stand for.
double neighbors_of(const Survey& survey, std::size_t q, double radius, double points_per_sample) {
  std::array<double, kNearest> nearest2;
  nearest2.fill(Box::kInf);
  std::size_t within = 0;
  for (std::size_t i = 0; i < survey.sample.size(); ++i) {
    if (i == q) continue;
    const double d2 = distance2(survey.sample[i], survey.sample[q]);
    within += d2 <= radius * radius;
    if (d2 >= nearest2.back()) continue;
    *std::prev(nearest2.end()) = d2;
    std::inplace_merge(nearest2.begin(), std::prev(nearest2.end()), nearest2.end());
  }
  const double farthest = std::sqrt(nearest2.back());
  if (within >= kNearest || points_per_sample == 1 || !(farthest > radius) || !std::isfinite(farthest))
    return static_cast<double>(within) * points_per_sample;
  return kNearest * points_per_sample * std::pow(radius / farthest, std::clamp(survey.dimension, 1.0, 3.0));
}

/// The most of the ascending `coordinates` in an interval of length `width`.
std::size_t most_within(const std::vector<double>& coordinates, double width) {
  std::size_t most = 0;
  for (std::size_t begin = 0, end = 0; end < coordinates.size(); ++end) {
    while (coordinates[end] - coordinates[begin] > width) ++begin;
    most = std::max(most, end - begin + 1);
  }
  return most;
}

double cost_of(const std::string& name) {
  const OperatorDeclaration* declaration = declaration_of(name);
  return declaration != nullptr ? declaration->neighbor_ns : kOtherCost;
}

/// Two digits, with commas: "4,100".
std::string rounded(double value) {
  const double unit = std::pow(10, std::max(0.0, std::floor(std::log10(std::max(value, 1.0))) - 1));
  std::string digits = fmt::format("{:.0f}", std::round(value / unit) * unit);
  for (auto at = static_cast<std::ptrdiff_t>(digits.size()) - 3; at > 0; at -= 3)
    digits.insert(static_cast<std::size_t>(at), ",");
  return digits;
}

std::string counted(double value, const char* unit) {
  const std::string digits = rounded(value);
  return fmt::format("{} {}{}", digits, unit, digits == "1" ? "" : "s");
}

}  // namespace

RadiusEstimate estimate_radius(const Survey& survey, std::uint64_t points, double radius, double width) {
  RadiusEstimate result;
  if (survey.sample.empty()) return result;
  const double sampled = static_cast<double>(survey.sample.size()), all = static_cast<double>(points);
  const double each = std::max(1.0, all / sampled);
  const std::size_t queries = std::min(kQueries, survey.sample.size());
  for (std::size_t q = 0; q < queries; ++q) {
    stop_if_cancelled();
    const double n = std::min(neighbors_of(survey, q * survey.sample.size() / queries, radius, each), all - 1);
    result.neighbors += n / static_cast<double>(queries);
    result.most_neighbors = std::max(result.most_neighbors, n);
  }
  std::vector<double> coordinates;
  for (const Vec3& p : survey.sample) coordinates.push_back(p[survey.axis]);
  std::ranges::sort(coordinates);
  const double most = static_cast<double>(most_within(coordinates, width));
  const double chance = each == 1 ? 0 : 2 * std::sqrt(most);  // by which the sample may fall short
  result.slice_points = static_cast<std::uint64_t>(std::min((most + chance) * each, all));
  return result;
}

double neighbor_seconds(const SweepPlan& plan, double neighbors) {
  double cost = kSearchCost * static_cast<double>(plan.step_count());  // where lists are not kept
  for (const Stage& stage : plan.stages) cost += cost_of(name_of(stage.op));
  return 1e-9 * cost * neighbors;
}

std::string neighbors_text(double neighbors_per_point) {
  return fmt::format("about {} per point", counted(neighbors_per_point, "neighbour"));
}

std::string about_time_text(double seconds) {
  const std::string time = seconds < 90       ? counted(std::max(1.0, seconds), "second")
                           : seconds < 5400   ? counted(seconds / 60, "minute")
                           : seconds < 172800 ? counted(seconds / 3600, "hour")
                                              : counted(seconds / 86400, "day");
  return "about " + time;
}

}  // namespace pointsweep
