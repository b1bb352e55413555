// SPDX-License-Identifier: MIT
/// Translates pipelines of PDAL, stage by stage, into stages of this library.
#pragma once

#include <string_view>
#include <vector>

#include "pointsweep/program/pipeline.h"

namespace pointsweep {

/// Returns whether the name has the form of PDAL's stages: `readers.las`, `filters.range`, `writers.copc`.
bool is_pdal_stage(std::string_view name);

/// Converts stages of PDAL to equivalent stages, in order, with their neighbourhoods. Readers and writers are dropped:
/// files are named on the command line. Throws UsageError for a stage, or an option of a stage, without an equivalent.
std::vector<StageText> stages_of_pdal(const std::vector<StageText>& stages);

}  // namespace pointsweep
