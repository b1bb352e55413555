// SPDX-License-Identifier: MIT
/// A neighbourhood as options of the pipeline stage `knn`.
#pragma once

#include "pointsweep/neighborhood.h"

namespace pointsweep {

/// Returns k, the radius and the options of the rule under their names in the stage `knn`. Leaves out k if it is
/// unlimited or the default of the operators (kOfOperators), and the radius if it is infinite.
Options options_of(const Neighborhood& neighborhood);

}  // namespace pointsweep
