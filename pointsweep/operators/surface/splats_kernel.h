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
  std::span<std::array<float, 3>> axis;  ///< unit vector along the major semi-axis
  std::span<float> length;               ///< length of the major semi-axis, in units of the cloud
  std::span<float> ratio;                ///< minor over major semi-axis, in [1/8, 1]
};

/// Fits the splats of all points of the batch, whose first attribute read is the normal. If `along_ridges`, the next
/// three attributes are the direction of k1, k1 and k2, which shape the ellipses of points that have curvatures. M_i
/// (Equation 1) shapes all other ellipses. Points without a splat get 0 and are marked as degenerate. The bits depend
/// only on a point's neighbourhood: not on the instruction set or the batch.
void fit_splats(const Neighborhoods& in, bool along_ridges, const SplatColumns& out, DegeneratePoints& degenerate);

}  // namespace pointsweep
