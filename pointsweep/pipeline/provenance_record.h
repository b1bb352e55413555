// SPDX-License-Identifier: MIT
/// What outputs say of the run that made them (formats/provenance.h).
#pragma once

#include <string>
#include <vector>

#include "pointsweep/formats/input_cloud.h"
#include "pointsweep/pipeline/engine_run.h"

namespace pointsweep {

/// All that an output of this run is to say: the records of the inputs, and with EngineOptions::provenance that of the
/// run. It holds what determines the result and nothing else. `stages`: canonical_stages() with presets left out, or
/// {"sort"}; `keep`: Chain::keep if it leaves anything out; `axis`: of the sweep.
std::vector<std::string> provenance_of(const InputCloud& cloud, const std::vector<std::string>& stages,
                                       const std::vector<std::string>& keep, const EngineOptions& options, int axis,
                                       bool drops_nonfinite);

}  // namespace pointsweep
