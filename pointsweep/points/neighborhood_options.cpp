// SPDX-License-Identifier: MIT
#include "pointsweep/points/neighborhood_options.h"

#include <cmath>

#include "pointsweep/fail.h"

namespace pointsweep {

SharedRule::~SharedRule() = default;

void refuse_value_size(std::size_t bytes, std::size_t asked) {
  fail_usage(
      "an operator asks for {} bytes of a value that has {}: give the type of the whole value, e.g. std::array<float, "
      "3> for a normal.",
      asked, bytes);
}

Options options_of(const Neighborhood& neighborhood) {
  Options options;
  const bool named = neighborhood.k != Neighborhood::kUnlimited && neighborhood.k != Neighborhood::kOfOperators;
  if (named) options.push_back({"k", std::uint64_t{neighborhood.k}});
  if (std::isfinite(neighborhood.radius)) options.push_back({"radius", neighborhood.radius});
  if (!neighborhood.rule) return options;
  const Options of_rule = neighborhood.rule->options();
  options.insert(options.end(), of_rule.begin(), of_rule.end());
  return options;
}

}  // namespace pointsweep
