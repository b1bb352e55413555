// SPDX-License-Identifier: MIT
/// The formats of the point files that a run writes.
#pragma once

#include <vector>

#include "pointsweep/formats/format.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/output/output_names.h"
#include "pointsweep/pipeline/plan/chain_plan.h"

namespace pointsweep {

/// A point file of each format among Outputs::points and Outputs::tiles; names without a known format are left out.
/// Throws UsageError for a name by which programs expect a format that is not written.
struct OutputFormat {
  const Format* format;
  std::filesystem::path example;  ///< the first output of that format
};
std::vector<OutputFormat> output_formats(const Outputs& outputs);

/// Returns the names of made attributes in all outputs (name_outputs()). Throws if a format refuses a name.
OutputNames names_in_outputs(const InputCloud& cloud, const ChainPlan& plan, const Outputs& outputs,
                             const EngineOptions& options);

/// Throws UsageError where nothing is to be written.
void require_outputs(const Outputs& outputs);

/// Throws UsageError for a request that only one output of all points can fulfil, if there are tiles.
void require_tiles_possible(const Outputs& outputs, const EngineOptions& options);

/// Returns the requirements of the outputs on the plan of a chain.
OutputNeeds needs_of(const Outputs& outputs, const EngineOptions& options);

/// Returns the name of the output in a sentence: the point file, the folder of the first tile, or "the output".
std::string name_of_output(const Outputs& outputs);

}  // namespace pointsweep
