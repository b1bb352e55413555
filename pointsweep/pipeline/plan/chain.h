// SPDX-License-Identifier: MIT
/// A chain of operators, as a user asks for it. plan_chain() resolves it (plan/chain_plan.h).
#pragma once

#include <string>
#include <vector>

#include "pointsweep/operators/chain_stage.h"
#include "pointsweep/points/neighborhood.h"

namespace pointsweep {

/// Neighbourhoods, and what is computed from them, in order.
struct Chain {
  Neighborhood neighborhood;
  std::vector<ChainStage> stages;
  /// What to write, of the made attributes and of the input's, by name (kept_fields.h); empty: everything.
  std::vector<std::string> keep = {};
};

}  // namespace pointsweep
