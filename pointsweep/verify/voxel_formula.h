// SPDX-License-Identifier: MIT
/// The formula of voxel(keep=centroid).
#pragma once

#include <memory>

#include "pointsweep/verify/cloud_formula.h"

namespace pointsweep {

class TakeVoxelMeans;
class VoxelMeans;

/// What leads to the values that are written is not looked at.
std::unique_ptr<CloudFormula> voxel_formula_of(const VoxelMeans& op);
/// `means`: what makes the means; null: not known.
std::unique_ptr<CloudFormula> voxel_formula_of(const TakeVoxelMeans& op, const VoxelMeans* means);

}  // namespace pointsweep
