// SPDX-License-Identifier: MIT
/// The ellipses of splats in vector lanes: a point per lane.
#pragma once

#include <cstddef>
#include <span>

#include "pointsweep/math/vec3.h"
#include "pointsweep/points/neighborhoods.h"

namespace pointsweep {

struct PointSplat {
  Vec3 axis;          ///< unit, of the major semi-axis
  double length = 0;  ///< of the major semi-axis, in lengths of the cloud; 0 where there is no splat
  double ratio = 0;   ///< minor over major
};

/// Of the points first to first + out.size() - 1, whose first attribute read is their normal. `along_ridges`: the next
/// three are the direction of k1, k1 and k2, and shape the ellipse where there are curvatures; elsewhere M_i does. The
/// bits depend on a point's neighbourhood alone: not on the instruction set, nor on what shares the batch.
void fit_splats(const Neighborhoods& in, std::size_t first, bool along_ridges, std::span<PointSplat> out);

}  // namespace pointsweep
