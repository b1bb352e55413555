// SPDX-License-Identifier: MIT
/// Pipelines of PDAL, stage by stage in ours.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/pipeline/language/parse.h"

namespace pointsweep {

/// Returns whether the name has the form of PDAL's stages: `readers.las`, `filters.range`, `writers.copc`.
bool is_pdal_stage(std::string_view name);

/// Returns stages that do what stages of PDAL do, in order, with the neighbourhoods that these have. Readers and
/// writers are left out: files are named on the command line. Throws UsageError, naming the stage, for one that we
/// lack, and for an option of it that we lack.
std::vector<StageText> stages_of_pdal(const std::vector<StageText>& stages);

}  // namespace pointsweep
