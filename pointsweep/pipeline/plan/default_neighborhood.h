// SPDX-License-Identifier: MIT
/// The neighbourhoods of a chain that names none.
#pragma once

#include "pointsweep/chain.h"

namespace pointsweep {

/// The chain with a neighbourhood in the place of each Neighborhood::kOfOperators, for the operators that stand before
/// the next Reneighbor that names its own: all points within their largest all_within, or as many as their largest
/// default_k says. Throws UsageError where one operator wants all within a distance and another does not.
Chain with_named_neighborhoods(Chain chain);

}  // namespace pointsweep
