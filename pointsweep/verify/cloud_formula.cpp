// SPDX-License-Identifier: MIT
#include "pointsweep/verify/cloud_formula.h"

#include <typeinfo>

#include "pointsweep/operators/distance_to.h"
#include "pointsweep/operators/height.h"
#include "pointsweep/operators/m3c2.h"
#include "pointsweep/verify/change_formulas.h"
#include "pointsweep/verify/height_formula.h"

namespace pointsweep {

const ColumnSource& CloudInput::source(std::size_t read) const {
  if (!reads[read]) throw NotTold("what it reads is not in the output");
  return *reads[read];
}

bool has_cloud_formula(const Operator& op) {
  const std::type_info& type = typeid(op);
  return type == typeid(DistanceTo) || type == typeid(M3c2) || type == typeid(Height);
}

std::unique_ptr<CloudFormula> cloud_formula_of(const Operator& op, std::span<const Operator* const> makers) {
  (void)makers;
  const std::type_info& type = typeid(op);
  if (type == typeid(DistanceTo)) return change_formula_of(static_cast<const DistanceTo&>(op));
  if (type == typeid(M3c2)) return change_formula_of(static_cast<const M3c2&>(op));
  if (type == typeid(Height)) return height_formula_of(static_cast<const Height&>(op));
  return nullptr;
}

}  // namespace pointsweep
