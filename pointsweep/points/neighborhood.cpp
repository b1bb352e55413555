// SPDX-License-Identifier: MIT
#include "pointsweep/points/neighborhood.h"

#include <cmath>

namespace pointsweep {

Options Neighborhood::options() const {
  Options options;
  if (k != kUnlimited) options.push_back({"k", std::uint64_t{k}});
  if (std::isfinite(radius)) options.push_back({"radius", radius});
  if (!rule) return options;
  const Options of_rule = rule->options();
  options.insert(options.end(), of_rule.begin(), of_rule.end());
  return options;
}

}  // namespace pointsweep
