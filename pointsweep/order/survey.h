// SPDX-License-Identifier: MIT
/// The survey of a cloud: a sample of its points, and properties estimated from the sample, found before the points are
/// put in order. An exact survey takes the bounds from all points.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "pointsweep/math/box.h"
#include "pointsweep/order/source.h"
#include "pointsweep/storage/encoding.h"

namespace pointsweep {

/// A sample of the cloud and the properties estimated from it. The sample is spread over all rows and equal in every
/// run.
struct Survey {
  std::vector<Vec3> sample;  ///< at most 65,536 finite points
  Box bounds;                ///< box of the sample, or of all finite points if `exact`
  bool exact = false;
  int axis = 0;          ///< sweep axis: the axis of the largest extent of `bounds`, unless the user chooses one
  double dimension = 2;  ///< estimate of the intrinsic dimension, in [1, 3], by counting occupied boxes

  void encode(Encoder& out) const;
  static Survey decode(Decoder& in);
};

/// Surveys the cloud. `exact`: reads the whole cloud, so that the axis does not depend on the order of its points.
Survey survey(const PointSource& source, std::optional<int> axis, bool exact);

/// Returns the box-counting dimension of a sample, in [1, 3]; outliers beyond the middle 98 % of each coordinate do not
/// count. Returns 2 if the sample cannot tell, for example because it is too small.
double box_counting_dimension(std::span<const Vec3> sample);

/// Returns a number of points per slab with which slabs are several point spacings thick: f * n^((D-1)/D), at least
/// 16,384. D is the dimension, clamped to [2, 3]. The factor f is 16 for D = 2 and 6 for D = 3, linear between.
std::uint64_t recommended_slab_points(std::uint64_t points, double dimension);

/// Throws Error if the cloud is so small or so large that squared distances would underflow or overflow in double
/// precision, so that points would be equally near. A cloud without extent is accepted.
void require_distances(const Box& bounds);

}  // namespace pointsweep
