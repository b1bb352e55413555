// SPDX-License-Identifier: MIT
/// Estimates the number of points within a radius, from the survey's sample before the work.
#pragma once

#include <cstdint>
#include <string>

#include "pointsweep/order/survey.h"
#include "pointsweep/sweep/plan.h"

namespace pointsweep {

struct RadiusEstimate {
  double neighbors = 0;            ///< of a point, on average
  double most_neighbors = 0;       ///< of a point in the densest place that the sample shows
  std::uint64_t slice_points = 0;  ///< most points between two planes across the axis, `width` apart
};

/// Estimates for a cloud of `points` points. Where fewer than 8 points of the sample lie within the radius, the count
/// follows from the distance of the 8th and the survey's dimension, within a factor of about two. Takes at most 0.1 s.
RadiusEstimate estimate_radius(const Survey& survey, std::uint64_t points, double radius, double width);

/// CPU seconds of search and operators for so many neighbours in all, within a factor of about two on one core of
/// 2.6 GHz.
double neighbor_seconds(const SweepPlan& plan, double neighbors);

/// "about 4,100 neighbours per point"
std::string neighbors_text(double neighbors_per_point);

/// "about 40 minutes"
std::string about_time_text(double seconds);

}  // namespace pointsweep
