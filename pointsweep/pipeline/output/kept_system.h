// SPDX-License-Identifier: MIT
/// Warning about outputs that keep the coordinate reference system of the input although a stage moves points.
#pragma once

#include <optional>
#include <string>

#include "pointsweep/crs.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/plan/chain_plan.h"

namespace pointsweep {

/// A warning where a stage assigns other coordinates, or an operator of a user makes them, and an output states the
/// system `crs` of the input all the same; empty where none is needed. The library's other operators move points within
/// their system. Other heights alone matter only where the system defines heights.
std::string kept_system_warning(const ChainPlan& plan, const std::optional<Crs>& crs, const Outputs& outputs);

}  // namespace pointsweep
