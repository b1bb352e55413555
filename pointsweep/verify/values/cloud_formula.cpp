// SPDX-License-Identifier: MIT
#include "pointsweep/verify/values/cloud_formula.h"

#include <algorithm>

namespace pointsweep {
namespace {

const std::vector<NamedCloudFormula>& all_cloud_formulas() {
  static const std::vector<NamedCloudFormula> all = [] {
    std::vector<NamedCloudFormula> list;
    for (const auto& more : {ground_formulas(), thinning_formulas(), change_formulas(), graph_formulas()})
      list.insert(list.end(), more.begin(), more.end());
    return list;
  }();
  return all;
}

}  // namespace

std::vector<Vec3> positions_of(std::span<const CloudPoint> points) {
  std::vector<Vec3> positions;
  for (const CloudPoint& p : points) positions.push_back(p.at.position);
  return positions;
}

const ColumnSource& CloudInput::source(std::size_t read) const {
  if (!reads[read]) throw NotTold("what it reads is not in the output");
  return *reads[read];
}

bool has_cloud_formula(const Operator& op) {
  return std::ranges::find(all_cloud_formulas(), op.name(), &NamedCloudFormula::name) != all_cloud_formulas().end();
}

std::unique_ptr<CloudFormula> cloud_formula_of(const Operator& op, std::span<const Operator* const> makers) {
  const auto found = std::ranges::find(all_cloud_formulas(), op.name(), &NamedCloudFormula::name);
  if (found == all_cloud_formulas().end()) return nullptr;
  FormulaSetup stage = setup_of(op);
  stage.makers = makers;
  return found->make(stage);
}

}  // namespace pointsweep
