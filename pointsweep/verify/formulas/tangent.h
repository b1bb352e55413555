// SPDX-License-Identifier: MIT
/// Directions in the tangent plane of a point.
#pragma once

#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep::formulas {

/// `along` of two orthogonal unit vectors, brought into the plane with unit normal n: it is projected where it is
/// nearer to the plane than `across` is, else it is the direction in the plane that is perpendicular to `across`.
/// `error` bounds the angle by which each of the two and n may be off.
Estimate tangent(Vector n, Vector along, Vector across, Real error);

}  // namespace pointsweep::formulas
