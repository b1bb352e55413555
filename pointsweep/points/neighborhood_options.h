// SPDX-License-Identifier: MIT
/// What tells one neighbourhood from another.
#pragma once

#include "pointsweep/neighborhood.h"

namespace pointsweep {

/// k, radius and the options of the rule, as far as they limit anything: as the stage `knn` takes them.
Options options_of(const Neighborhood& neighborhood);

}  // namespace pointsweep
