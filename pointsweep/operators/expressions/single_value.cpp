// SPDX-License-Identifier: MIT
#include "pointsweep/operators/expressions/single_value.h"

#include <algorithm>

namespace pointsweep {

std::optional<Attribute> single_value(const char* name, const Schema& input, std::span<const Attribute> made) {
  const auto own =
      std::ranges::find_if(made, [&](const Attribute& a) { return a.name == name && a.fields.size() == 1; });
  if (own != made.end()) return *own;
  const auto at = input.find(name);
  if (!at || input.fields[*at].count != 1) return {};
  return scalar(input.fields[*at].name, Type::f64, "1", name);
}

}  // namespace pointsweep
