// SPDX-License-Identifier: MIT
/// The formula of voxel(keep=centroid).
#pragma once

#include "pointsweep/verify/values/cloud_formula.h"

namespace pointsweep {

/// Returns the formula of the means of voxel(keep=centroid). A voxel that only keeps rows has nothing to evaluate.
NamedCloudFormula voxel_formula();

}  // namespace pointsweep
