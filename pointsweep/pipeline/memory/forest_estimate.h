// SPDX-License-Identifier: MIT
/// Estimates the number of points of a forest that are open at once, and chooses the places between its buckets; both
/// from the survey's sample, before the work.
#pragma once

#include <cstdint>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/order/survey.h"

namespace pointsweep {

/// Estimates, for a cloud of `points` points, the most points that have neighbours on both sides of a front across the
/// axis. `k`: nearest neighbours. Uses a sample of at most 16,384 points and the places of their 8 nearest. Takes at
/// most 0.1 s.
std::uint64_t estimate_open_points(const Survey& survey, std::uint64_t points, std::uint64_t k);

/// Places of the sample, in no particular order, between which there are about kBucketPoints points each, however the
/// points lie along the axis. Of points with equal coordinates along the axis the other coordinates decide.
std::vector<Vec3> places_between_buckets(const Survey& survey, std::uint64_t points);

}  // namespace pointsweep
