// SPDX-License-Identifier: MIT
/// The declarations of Reneighbor and Resort (chain.h), the update operators that the paper asks for after points have
/// moved (Section 8). They compute nothing for a point: they tell the planner where a new sweep begins and how the
/// output is ordered.
#pragma once

#include "pointsweep/chain.h"

namespace pointsweep {}  // namespace pointsweep
