// SPDX-License-Identifier: MIT
#include "pointsweep/points/neighborhood_options.h"

#include <cmath>

namespace pointsweep {

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
