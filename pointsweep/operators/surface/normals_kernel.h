// SPDX-License-Identifier: MIT
/// Equation 1 in vector lanes: a point per lane.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "pointsweep/neighborhood.h"
#include "pointsweep/points/degenerate_points.h"

namespace pointsweep {

/// The unit normal of every point of the batch, the first of its largest components positive; (0, 0, 0) where Normals
/// calls it degenerate. Such points are marked. The bits of a normal depend on its own neighbourhood alone: not on the
/// instruction set, nor on what shares the batch.
void unoriented_normals(const Neighborhoods& in, std::span<std::array<float, 3>> normals, DegeneratePoints& degenerate);

}  // namespace pointsweep
