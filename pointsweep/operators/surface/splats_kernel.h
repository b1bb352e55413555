// SPDX-License-Identifier: MIT
/// The ellipses of splats in vector lanes: a point per lane.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "pointsweep/neighborhood.h"
#include "pointsweep/points/degenerate_points.h"

namespace pointsweep {

/// The columns that Splats makes, each as long as the batch.
struct SplatColumns {
  std::span<std::array<float, 3>> axis;  ///< unit, of the major semi-axis
  std::span<float> length;               ///< length of the major semi-axis, in units of the cloud
  std::span<float> ratio;                ///< minor over major, in [1/8, 1]
};

/// Fits the splats of all points of the batch, whose first attribute read is their normal. `along_ridges`: the next
/// three are the direction of k1, k1 and k2, and shape the ellipse where there are curvatures; elsewhere M_i does.
/// Points without a splat get 0 and are marked. The bits depend only on a point's neighbourhood: not on the instruction
/// set or the batch.
void fit_splats(const Neighborhoods& in, bool along_ridges, const SplatColumns& out, DegeneratePoints& degenerate);

}  // namespace pointsweep
