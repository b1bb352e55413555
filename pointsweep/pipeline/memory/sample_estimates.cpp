// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/memory/sample_estimates.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "pointsweep/cancellation.h"
#include "pointsweep/connect/forest_edge.h"
#include "pointsweep/program/pipeline.h"
#include "pointsweep/program/quantities.h"
#include "pointsweep/sweep/stage_runner.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

constexpr std::size_t kQueries = 512;
constexpr std::size_t kNearest = 8;  ///< number of nearest sample points from whose distance the density is estimated

/// Nanoseconds that a search, or an operator without a declared cost, takes for each neighbour. Measured with
/// `script/bench radius` at about 1,000 neighbours.
constexpr double kSearchCost = 20, kOtherCost = 10;

/// Returns the distance from sample point `q` to the kNearest-th nearest other sample point; infinity if there is none.
double distance_of_nearest(const std::vector<Vec3>& sample, std::size_t q) {
  std::array<double, kNearest> nearest2;
  nearest2.fill(Box::kInf);
  for (std::size_t i = 0; i < sample.size(); ++i) {
    const double d2 = distance2(sample[i], sample[q]);
    if (d2 >= nearest2.back() || i == q) continue;
    *std::prev(nearest2.end()) = d2;
    std::inplace_merge(nearest2.begin(), std::prev(nearest2.end()), nearest2.end());
  }
  return std::sqrt(nearest2.back());
}

/// Returns the estimated number of points within the radius of sample point `q`.
double neighbors_of(const Survey& survey, std::size_t q, double radius, double points_per_sample) {
  const Vec3 center = survey.sample[q];
  const double radius2 = radius * radius;
  std::size_t with_itself = 0;
  for (const Vec3& p : survey.sample) with_itself += distance2(p, center) <= radius2;
  const std::size_t within = with_itself - 1;
  const auto counted = static_cast<double>(within) * points_per_sample;
  if (within >= kNearest || points_per_sample == 1) return counted;
  const double farthest = distance_of_nearest(survey.sample, q);
  if (!(farthest > radius) || !std::isfinite(farthest)) return counted;
  return kNearest * points_per_sample * std::pow(radius / farthest, std::clamp(survey.dimension, 1.0, 3.0));
}

/// Returns the largest number of coordinates that lie in one interval of length `width`. `coordinates` must ascend.
std::size_t most_within(const std::vector<double>& coordinates, double width) {
  std::size_t most = 0;
  for (std::size_t begin = 0, end = 0; end < coordinates.size(); ++end) {
    while (coordinates[end] - coordinates[begin] > width) ++begin;
    most = std::max(most, end - begin + 1);
  }
  return most;
}

double points_per_sample(const Survey& survey, std::uint64_t points) {
  return std::max(1.0, static_cast<double>(points) / static_cast<double>(survey.sample.size()));
}

double cost_of(const std::string& name) {
  const OperatorDeclaration* declaration = declaration_of(name);
  return declaration != nullptr ? declaration->neighbor_ns : kOtherCost;
}

/// Returns the value rounded to two significant digits, with commas: "4,100".
std::string rounded(double value) {
  const double unit = std::pow(10, std::max(0.0, std::floor(std::log10(std::max(value, 1.0))) - 1));
  return grouped_text(static_cast<std::uint64_t>(std::round(value / unit) * unit));
}

std::string counted(double value, const char* unit) {
  const std::string digits = rounded(value);
  return fmt::format("{} {}{}", digits, unit, digits == "1" ? "" : "s");
}

constexpr std::size_t kPlaces = 1024, kMostOthers = 16384, kOffsets = 8;

/// Returns at most `most` points of the sample, evenly spaced.
std::vector<Vec3> some_of(const std::vector<Vec3>& sample, std::size_t most) {
  const std::size_t n = std::min(most, sample.size());
  std::vector<Vec3> some(n);
  for (std::size_t i = 0; i < n; ++i) some[i] = sample[i * sample.size() / n];
  return some;
}

using Offsets = std::array<Vec3, kOffsets>;

/// Returns the offsets from `place`, which is one of `others`, to its kOffsets nearest other places.
Offsets nearest_offsets(Vec3 place, const std::vector<Vec3>& others) {
  std::array<std::pair<double, std::size_t>, kOffsets + 1> nearest;
  nearest.fill({Box::kInf, 0});
  for (std::size_t i = 0; i < others.size(); ++i) {
    const double d2 = distance2(others[i], place);
    if (d2 >= nearest.back().first) continue;
    nearest.back() = {d2, i};
    std::inplace_merge(nearest.begin(), std::prev(nearest.end()), nearest.end());
  }
  Offsets offsets;  // offsets to others, without the point itself, which is the nearest
  for (std::size_t j = 0; j < kOffsets; ++j) offsets[j] = others[nearest[j + 1].second] - place;
  return offsets;
}

/// Returns an offset for a cloud in which neighbours are `scale` times as far apart: limits each coordinate to `scale`
/// times the length of the offset. Smaller coordinates stay unchanged, since noise across a wall does not decrease with
/// more points.
Vec3 scaled(Vec3 offset, double scale) {
  const double most = scale * length(offset);
  for (const int c : {0, 1, 2}) offset[c] = std::clamp(offset[c], -most, most);
  return offset;
}

/// Returns the largest number of places that are open at once: a place is open while a plane that moves along the axis
/// lies between its first and its last neighbour. Neighbours are assumed at the scaled offsets and opposite to them.
std::size_t most_open(const std::vector<Vec3>& places, const std::vector<Offsets>& offsets, double scale, int axis) {
  const AlongAxis along{axis};
  std::vector<PointKey> begins, ends;
  for (std::size_t q = 0; q < places.size(); ++q) {
    PointKey first{places[q], q}, last = first;  // the row breaks ties, so that copies of a point are not open together
    for (const Vec3& offset : offsets[q]) {
      const Vec3 reach = scaled(offset, scale);
      const PointKey one{places[q] + reach, q}, other{places[q] - reach, q};
      first = std::min({first, one, other}, along);
      last = std::max({last, one, other}, along);
    }
    begins.push_back(first);
    ends.push_back(last);
  }
  std::ranges::sort(begins, along);
  std::ranges::sort(ends, along);
  std::size_t most = 0;
  for (std::size_t opened = 0, closed = 0; opened < begins.size(); ++opened) {
    while (along(ends[closed], begins[opened])) ++closed;
    most = std::max(most, opened + 1 - closed);
  }
  return most;
}

}  // namespace

RadiusEstimate estimate_radius(const Survey& survey, std::uint64_t points, double radius) {
  RadiusEstimate result;
  if (survey.sample.empty()) return result;
  const double all = static_cast<double>(points), each = points_per_sample(survey, points);
  const std::size_t queries = std::min(kQueries, survey.sample.size());
  for (std::size_t q = 0; q < queries; ++q) {
    stop_if_cancelled();
    const std::size_t at = q * survey.sample.size() / queries;
    const double n = std::min(neighbors_of(survey, at, radius, each), all - 1);
    result.neighbors += n / static_cast<double>(queries);
    result.most_neighbors = std::max(result.most_neighbors, n);
  }
  return result;
}

std::uint64_t estimate_slice(const Survey& survey, std::uint64_t points, double width) {
  if (survey.sample.empty()) return 0;
  std::vector<double> coordinates;
  for (const Vec3& p : survey.sample) coordinates.push_back(p[survey.axis]);
  std::ranges::sort(coordinates);
  const double most = static_cast<double>(most_within(coordinates, width)), each = points_per_sample(survey, points);
  const double chance = each == 1 ? 0 : 2 * std::sqrt(most);  // two standard deviations of a count
  return static_cast<std::uint64_t>(std::min((most + chance) * each, static_cast<double>(points)));
}

double neighbor_seconds(const SweepPlan& plan, double neighbors) {
  double cost = kSearchCost * static_cast<double>(plan.step_count());  // every step searches its lists again
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

/// Estimates the number of open points: points whose first neighbour along the axis the sweep has passed, and whose
/// last neighbour it has not. Returns the larger of two estimates from the sample. The first moves neighbours to the
/// distances expected in the whole cloud, counts open points, and subtracts the possible error of the count. It is the
/// larger one if many points are open, as for a wall across the axis. The second takes the share of the sample that is
/// open, and scales it to the distances in the whole cloud.
std::uint64_t estimate_open_points(const Survey& survey, std::uint64_t points, std::uint64_t k) {
  const std::vector<Vec3> others = some_of(survey.sample, kMostOthers), places = some_of(others, kPlaces);
  if (others.size() <= kOffsets) return points;
  std::vector<Offsets> offsets(places.size());
  parallel_for(places.size(), [&](std::size_t q, unsigned) { offsets[q] = nearest_offsets(places[q], others); });
  const double all = static_cast<double>(points), dimension = std::clamp(survey.dimension, 1.0, 3.0);
  const double thinner = static_cast<double>(std::min(k, points)) / kOffsets * static_cast<double>(others.size()) / all;
  const double scale = std::pow(thinner, 1 / dimension);
  const auto share = [&](double open) { return open / static_cast<double>(places.size()); };
  const auto seen = static_cast<double>(most_open(places, offsets, scale, survey.axis));
  const double surely = std::max(0.0, seen - 2 * std::sqrt(seen));
  const double of_sample = share(static_cast<double>(most_open(places, offsets, 1, survey.axis)));
  return static_cast<std::uint64_t>(std::ceil(all * std::min(1.0, std::max(share(surely), of_sample * scale))));
}

std::vector<Vec3> places_between_buckets(const Survey& survey, std::uint64_t points) {
  std::vector<Vec3> sorted = survey.sample, places;
  std::ranges::sort(sorted, AlongAxis{survey.axis}, [](Vec3 place) { return PointKey{place}; });
  const double buckets = std::ceil(static_cast<double>(points) / static_cast<double>(kBucketPoints));
  const double step = std::max(1.0, static_cast<double>(sorted.size()) / buckets);
  for (double at = step; at < static_cast<double>(sorted.size()); at += step)
    places.push_back(sorted[static_cast<std::size_t>(at)]);
  return places;
}

}  // namespace pointsweep
