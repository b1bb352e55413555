// SPDX-License-Identifier: MIT
/// The neighbourhoods of a chain that names none.
#pragma once

#include "pointsweep/chain.h"

namespace pointsweep {

/// Returns the chain with each Neighborhood::kOfOperators replaced, for the operators up to the next Reneighbor with
/// its own definition: by all points within their largest all_within, or by their largest default_k. Throws UsageError
/// if one operator needs all points within a distance and another does not.
Chain with_named_neighborhoods(Chain chain);

}  // namespace pointsweep
