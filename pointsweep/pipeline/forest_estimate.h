// SPDX-License-Identifier: MIT
/// How many points of a forest are open at once, estimated from the survey's sample before the work; and how its
/// buckets are divided.
#pragma once

#include <cstdint>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/order/survey.h"

namespace pointsweep {

/// Points of a cloud of `points` points that have neighbours before and behind some front, the most along the axis.
/// `k`: nearest neighbours. Of a sample of at most 16,384 points, by the places of their 8 nearest. At most 0.1 s.
std::uint64_t estimate_open_points(const Survey& survey, std::uint64_t points, std::uint64_t k);

/// Places of the sample, in no particular order, between which there are about kBucketPoints points each, however the
/// points lie along the axis. Of points with equal coordinates along the axis the other coordinates decide.
std::vector<Vec3> places_between_buckets(const Survey& survey, std::uint64_t points);

}  // namespace pointsweep
