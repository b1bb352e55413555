// SPDX-License-Identifier: MIT
/// The options that tell one neighbourhood from another.
#pragma once

#include "pointsweep/neighborhood.h"

namespace pointsweep {

/// Returns k, radius and the options of the rule, in the form that the stage `knn` takes. Options that limit nothing
/// are left out.
Options options_of(const Neighborhood& neighborhood);

}  // namespace pointsweep
