// SPDX-License-Identifier: MIT
/// The options that describe a neighbourhood.
#pragma once

#include "pointsweep/neighborhood.h"

namespace pointsweep {

/// Returns k, the radius and the options of the rule, in the form that the stage `knn` takes. A k or radius that limits
/// nothing is left out.
Options options_of(const Neighborhood& neighborhood);

}  // namespace pointsweep
