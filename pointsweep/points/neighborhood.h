// SPDX-License-Identifier: MIT
/// Which points are the neighbours of a point.
#pragma once

#include <cstddef>
#include <limits>

#include "pointsweep/points/neighborhood_rule.h"
#include "pointsweep/points/option_value.h"

namespace pointsweep {

/// What a neighbourhood is: the `k` nearest points, those within `radius` (inclusive), or the k nearest of these; and,
/// where there is a rule, the first of these that it keeps. Searches find what k and radius say; the sweep and the
/// recall apply the rule.
struct Neighborhood {
  static constexpr std::size_t kUnlimited = std::numeric_limits<std::size_t>::max();
  std::size_t k = 8;
  double radius = std::numeric_limits<double>::infinity();
  SharedRule rule = {};
  double radius2() const { return radius * radius; }
  /// k, radius and the options of the rule, as far as they limit anything: as the stage `knn` takes them.
  Options options() const;
};

}  // namespace pointsweep
