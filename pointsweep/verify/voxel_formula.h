// SPDX-License-Identifier: MIT
/// The formula of voxel(keep=centroid).
#pragma once

#include "pointsweep/verify/cloud_formula.h"

namespace pointsweep {

/// Of a voxel that only keeps rows there is nothing to evaluate.
NamedCloudFormula voxel_formula();

}  // namespace pointsweep
