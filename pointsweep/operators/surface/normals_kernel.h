// SPDX-License-Identifier: MIT
/// Normals by Equation 1 of the paper (normals.h) in vector lanes: a point per lane.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "pointsweep/neighborhood.h"
#include "pointsweep/points/degenerate_points.h"

namespace pointsweep {

/// Computes the unit normal of every point of the batch; the first of its largest components is positive. Points that
/// are degenerate by the definition of Normals get (0, 0, 0) and are marked as such. The bits depend only on a point's
/// neighbourhood: not on the instruction set or the batch.
void unoriented_normals(const Neighborhoods& in, std::span<std::array<float, 3>> normals, DegeneratePoints& degenerate);

}  // namespace pointsweep
