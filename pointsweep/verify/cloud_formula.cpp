// SPDX-License-Identifier: MIT
#include "pointsweep/verify/cloud_formula.h"

#include <algorithm>
#include <typeinfo>

#include "pointsweep/operators/connected_components.h"
#include "pointsweep/operators/density_clusters.h"
#include "pointsweep/operators/distance_to.h"
#include "pointsweep/operators/ground.h"
#include "pointsweep/operators/height.h"
#include "pointsweep/operators/m3c2.h"
#include "pointsweep/operators/orient.h"
#include "pointsweep/operators/segments.h"
#include "pointsweep/operators/voxel_centroid.h"
#include "pointsweep/verify/change_formulas.h"
#include "pointsweep/verify/graph_formulas.h"
#include "pointsweep/verify/ground_formula.h"
#include "pointsweep/verify/height_formula.h"
#include "pointsweep/verify/voxel_formula.h"

namespace pointsweep {
namespace {

/// Exactly this class: one derived from it may mean something else.
template <class Op>
const Op* as(const Operator* op) {
  return op != nullptr && typeid(*op) == typeid(Op) ? static_cast<const Op*>(op) : nullptr;
}

template <class... Ops>
bool is_one_of(const Operator& op) {
  return (... || (as<Ops>(&op) != nullptr));
}

}  // namespace

const ColumnSource& CloudInput::source(std::size_t read) const {
  if (!reads[read]) throw NotTold("what it reads is not in the output");
  return *reads[read];
}

bool has_cloud_formula(const Operator& op) {
  return is_one_of<DistanceTo, M3c2, Height, Ground, ConnectedComponents, ClustersOfCores, Segments, NormalSigns,
                   VoxelMeans, TakeVoxelMeans>(op);
}

std::unique_ptr<CloudFormula> cloud_formula_of(const Operator& op, std::span<const Operator* const> makers) {
  if (const auto* change = as<DistanceTo>(&op)) return change_formula_of(*change);
  if (const auto* change = as<M3c2>(&op)) return change_formula_of(*change);
  if (const auto* height = as<Height>(&op)) return height_formula_of(*height);
  if (const auto* ground = as<Ground>(&op)) return ground_formula_of(*ground);
  if (const auto* components = as<ConnectedComponents>(&op)) return graph_formula_of(*components);
  if (const auto* clusters = as<ClustersOfCores>(&op)) return graph_formula_of(*clusters, as<CorePoints>(makers[0]));
  if (const auto* segments = as<Segments>(&op)) return graph_formula_of(*segments);
  if (const auto* signs = as<NormalSigns>(&op)) return graph_formula_of(*signs);
  if (const auto* means = as<VoxelMeans>(&op)) return voxel_formula_of(*means);
  if (const auto* taken = as<TakeVoxelMeans>(&op)) return voxel_formula_of(*taken, as<VoxelMeans>(makers[0]));
  return nullptr;
}

}  // namespace pointsweep
