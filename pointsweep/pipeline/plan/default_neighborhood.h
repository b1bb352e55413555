// SPDX-License-Identifier: MIT
/// The default number of neighbours of a chain.
#pragma once

#include "pointsweep/chain.h"

namespace pointsweep {

/// The chain with a number in the place of each Neighborhood::kOfOperators: the largest default_k of the operators
/// that the neighbourhood is for, which stand before the next Reneighbor that names its own.
Chain with_named_neighborhoods(Chain chain);

}  // namespace pointsweep
