// SPDX-License-Identifier: MIT
/// Independent evaluation of stages whose values depend on all points of a cloud: a search in another cloud, a raster,
/// a graph. Values that such a stage reads are taken from the input, from the output, where they are checked
/// separately, or from the operators themselves, which compute them again (ColumnSource).
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/operator.h"
#include "pointsweep/verify/formulas/estimate.h"
#include "pointsweep/verify/rows/cloud_rows.h"
#include "pointsweep/verify/search/surroundings.h"
#include "pointsweep/verify/values/stage_formula.h"

namespace pointsweep {

/// A point to be evaluated, with the values that the stage reads of it, in the order of the stage's contract.
struct CloudPoint {
  KnownPoint at;
  Estimates reads;
};

/// Returns the positions of the points, in their order.
std::vector<Vec3> positions_of(std::span<const CloudPoint> points);

struct CloudInput {
  CloudRows& rows;
  /// Sources of the values that are read for all rows, in the order of the contract; absent for a value without a
  /// source.
  std::vector<std::optional<ColumnSource>> reads;
  std::vector<std::optional<ColumnSource>> makes;  ///< sources in the output of the values that the stage makes
  NeighborRule neighborhood;
  bool has_rule;                       ///< true if a rule keeps a part of the neighbours
  InputCloud* before_means = nullptr;  ///< points before the stage voxel(keep=centroid); null without such a stage

  /// Returns the source of a value that is read. Throws NotTold if it has none.
  const ColumnSource& source(std::size_t read) const;
};

class CloudFormula {
 public:
  virtual ~CloudFormula() = default;
  /// Reads all points if evaluate() needs their values. Must be called once, before the first evaluate(). Throws
  /// NotTold if the stage cannot be checked.
  virtual void prepare(const CloudInput&) {}
  /// Returns a clause, without a full stop, about the values that are not checked; empty if all are checked.
  virtual std::string limits() const { return {}; }
  /// Returns for each point the estimates of the values that the stage makes, in the form of StageFormula.
  virtual std::vector<Estimates> evaluate(std::span<const CloudPoint> points, const CloudInput& in) = 0;
  /// Returns the values of a point whose coordinates are not all finite; none if the stage leaves such points
  /// unchanged.
  virtual std::optional<Estimates> unplaced(const CloudPoint&) const { return std::nullopt; }
};

/// The name of an operator, and the function that makes its formula over the whole cloud.
struct NamedCloudFormula {
  std::string_view name;
  std::unique_ptr<CloudFormula> (*make)(const FormulaSetup& stage);
};

template <class Formula>
std::unique_ptr<CloudFormula> cloud_formula_made(const FormulaSetup& stage) {
  return std::make_unique<Formula>(stage);
}

/// Returns whether a formula over the whole cloud has the name of the operator.
bool has_cloud_formula(const Operator& op);
/// Returns the formula of an operator; null for local operators, if no formula has the name of the operator, and for a
/// voxel that only keeps rows. `makers`: the operator that makes each attribute of contract().reads, or null for
/// attributes of the input.
std::unique_ptr<CloudFormula> cloud_formula_of(const Operator& op, std::span<const Operator* const> makers);

/// Returns the formulas of the classes that the ground filter gives, and of heights above the ground.
std::vector<NamedCloudFormula> ground_formulas();

/// Returns the formulas of the means of voxel(keep=centroid), and of levels of detail.
std::vector<NamedCloudFormula> thinning_formulas();

/// Returns the formulas of the operators that read another cloud.
std::vector<NamedCloudFormula> change_formulas();

/// Returns the formulas of the operators that connect points, which use the whole graph if it fits in memory.
std::vector<NamedCloudFormula> graph_formulas();

}  // namespace pointsweep
