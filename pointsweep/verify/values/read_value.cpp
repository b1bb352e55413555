// SPDX-License-Identifier: MIT
#include "pointsweep/verify/values/read_value.h"

#include "pointsweep/operators/expressions/meant_value.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {

ReadValue read_of(const std::string& name, const std::vector<Attribute>& reads) {
  if (const MeantValue meant = meant_value(name, Schema{}, reads); meant.made != nullptr)
    return {static_cast<int>(meant.made - reads.data()), meant.component};
  return {-1, static_cast<std::size_t>(library_name_of(name).front() - 'x')};
}

formulas::Estimate estimate_of(const ReadValue& value, const FormulaInput& in) {
  if (value.attribute < 0) return {.value = in.place.at, .error = in.place.error};
  return in.reads[static_cast<std::size_t>(value.attribute)];
}

formulas::Real component_of(const formulas::Estimate& estimate, const ReadValue& value) {
  const formulas::Vector& v = estimate.value;
  return value.component == 0 ? v.x : value.component == 1 ? v.y : v.z;
}

}  // namespace pointsweep
