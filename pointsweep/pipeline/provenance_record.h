// SPDX-License-Identifier: MIT
/// What outputs say of the run that made them (formats/provenance.h).
#pragma once

#include <string>
#include <vector>

#include "pointsweep/formats/cloud.h"
#include "pointsweep/formats/provenance.h"
#include "pointsweep/pipeline/parse.h"
#include "pointsweep/pipeline/pipeline.h"

namespace pointsweep {

/// The stages as texts that are equal whenever the pipelines are: options in the order of their declaration, without
/// those that have their preset value, numbers in their shortest form, the neighbourhood always first.
/// For RunOptions::stages.
std::vector<std::string> canonical_stages(const std::vector<StageText>& stages);

/// All that an output of this run is to say: the records of the inputs, and that of the run if RunOptions::stages has
/// any. It holds what determines the result and nothing else. `keep`: Chain::keep if it leaves anything out; `axis`: of
/// the sweep.
std::vector<std::string> provenance_of(const Cloud& cloud, const std::vector<std::string>& keep,
                                       const RunOptions& options, int axis, bool drops_nonfinite);

}  // namespace pointsweep
