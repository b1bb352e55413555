// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/memory/forest_estimate.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "pointsweep/connect/forest_edge.h"
#include "pointsweep/sweep/stage_runner.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

constexpr std::size_t kPlaces = 1024, kMostOthers = 16384, kOffsets = 8;

/// At most `most` of the sample, evenly spaced.
std::vector<Vec3> some_of(const std::vector<Vec3>& sample, std::size_t most) {
  const std::size_t n = std::min(most, sample.size());
  std::vector<Vec3> some(n);
  for (std::size_t i = 0; i < n; ++i) some[i] = sample[i * sample.size() / n];
  return some;
}

using Offsets = std::array<Vec3, kOffsets>;

/// From `place`, one of `others`, to those nearest to it.
Offsets nearest_offsets(Vec3 place, const std::vector<Vec3>& others) {
  std::array<std::pair<double, std::size_t>, kOffsets + 1> nearest;
  nearest.fill({Box::kInf, 0});
  for (std::size_t i = 0; i < others.size(); ++i) {
    const double d2 = distance2(others[i], place);
    if (d2 >= nearest.back().first) continue;
    nearest.back() = {d2, i};
    std::inplace_merge(nearest.begin(), std::prev(nearest.end()), nearest.end());
  }
  Offsets offsets;  // without itself, which is the nearest
  for (std::size_t j = 0; j < kOffsets; ++j) offsets[j] = others[nearest[j + 1].second] - place;
  return offsets;
}

/// An offset in a cloud whose neighbours are at `scale` times the distance. A coordinate is not scaled where it stays
/// below the distance: noise across a wall does not become less with more points.
Vec3 scaled(Vec3 offset, double scale) {
  const double most = scale * length(offset);
  for (const int c : {0, 1, 2}) offset[c] = std::clamp(offset[c], -most, most);
  return offset;
}

/// The most of the places that are between the first and the last of their neighbours at once. These are at the scaled
/// offsets, or opposite to that.
std::size_t most_open(const std::vector<Vec3>& places, const std::vector<Offsets>& offsets, double scale, int axis) {
  const AlongAxis along{axis};
  std::vector<PointKey> begins, ends;
  for (std::size_t q = 0; q < places.size(); ++q) {
    PointKey first{places[q], q}, last = first;  // copies of a point are not open together
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

/// The share that is open follows from the spacing of the points in two ways: with the neighbours at the distances that
/// they should have in the whole cloud, if there are enough open points to tell, as where a wall lies across the axis;
/// and from the share of the sample, which is a layer as thick as the sample's spacing.
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
