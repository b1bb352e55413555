// SPDX-License-Identifier: MIT
/// Estimates from the survey's sample, before the work: the number of points within a radius or in a slice; the time
/// that neighbours take; the number of points of a spanning forest that are open (have unknown edges) at once; places
/// that divide the forest's points into buckets.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/order/survey.h"
#include "pointsweep/sweep/plan.h"

namespace pointsweep {

struct RadiusEstimate {
  double neighbors = 0;       ///< average number per point
  double most_neighbors = 0;  ///< largest number among the points of the sample that are looked at
};

/// Estimates the numbers of neighbours within a radius, for a cloud of `points` points, at up to 512 points of the
/// sample. If fewer than 8 points of the sample lie within the radius of a point, the estimate follows from the
/// distance of the 8th nearest one and the survey's dimension, within a factor of about two; a sample of all points is
/// counted. Takes at most 0.1 s.
RadiusEstimate estimate_radius(const Survey& survey, std::uint64_t points, double radius);

/// Estimates, for a cloud of `points` points, the most points between two planes across the axis, `width` apart.
std::uint64_t estimate_slice(const Survey& survey, std::uint64_t points, double width);

/// Returns the CPU seconds of search and operators for a total of `neighbors` neighbours, within a factor of about two
/// on one core of 2.6 GHz.
double neighbor_seconds(const SweepPlan& plan, double neighbors);

/// Returns a text such as "about 4,100 neighbours per point".
std::string neighbors_text(double neighbors_per_point);

/// Returns a text such as "about 40 minutes".
std::string about_time_text(double seconds);

/// Estimates, for a cloud of `points` points, the most points that have neighbours on both sides of a plane across the
/// axis. `k`: number of nearest neighbours of a point. Uses at most 16,384 points of the sample, and the places of the
/// 8 nearest neighbours of at most 1,024 of them; a sample of at most 8 points gives `points`. Takes at most 0.1 s.
std::uint64_t estimate_open_points(const Survey& survey, std::uint64_t points, std::uint64_t k);

/// Returns points of the sample, ascending along the axis, that divide a cloud of `points` points into buckets of about
/// kBucketPoints points each, however the points are distributed. Equal coordinates along the axis are ordered by the
/// other coordinates.
std::vector<Vec3> places_between_buckets(const Survey& survey, std::uint64_t points);

/// Estimates from a survey. Each estimate is computed once and stored, since plan_run_memory() needs it many times.
class Estimates {
 public:
  Estimates(const Survey& survey, std::uint64_t points) : survey_(survey), points_(points) {}
  RadiusEstimate radius(double radius) {
    return known(radii_, radius, [&] { return estimate_radius(survey_, points_, radius); });
  }
  std::uint64_t slice(double width) {
    return known(slices_, width, [&] { return estimate_slice(survey_, points_, width); });
  }
  std::uint64_t open_points(std::uint64_t k) {
    return known(open_, k, [&] { return estimate_open_points(survey_, points_, k); });
  }
  const Survey& survey() const { return survey_; }

 private:
  template <class Key, class Value, class Make>
  static Value known(std::map<Key, Value>& values, Key key, Make make) {
    const auto at = values.find(key);
    return at != values.end() ? at->second : values.emplace(key, make()).first->second;
  }

  const Survey& survey_;
  std::uint64_t points_;
  std::map<double, RadiusEstimate> radii_;
  std::map<double, std::uint64_t> slices_;
  std::map<std::uint64_t, std::uint64_t> open_;
};

}  // namespace pointsweep
