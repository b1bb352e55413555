// SPDX-License-Identifier: MIT
/// Builds the chain of a pipeline from facts about its cloud (Facts), above all the unit of its lengths, checks that
/// lengths have a unit, writes chains as text, and makes the file names in a pipeline absolute.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/chain.h"
#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/neighborhood.h"
#include "pointsweep/operators/kinds/stage_operator.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/program/declaration.h"
#include "pointsweep/program/pipeline.h"

namespace pointsweep {

/// Returns the facts about the cloud that the construction of stages depends on.
Facts facts_of(const InputCloud& cloud);

/// Returns the declarations for a cloud whose unit has `metres_per_unit` metres: default lengths, declared in metres,
/// are converted to that unit.
std::vector<OptionDeclaration> in_unit(std::vector<OptionDeclaration> options, double metres_per_unit);

/// Throws UsageError if the coordinates are degrees and a stage uses distances, unless CloudOptions::ignore_crs is set.
void require_lengths(const InputCloud& cloud, const Chain& chain);

/// Returns sentences about what users may not expect of the inputs: points in the buffers of tiles; heights in another
/// unit than x and y, for a stage that depends on distances; and for each stage with default lengths, a unit of the
/// coordinate reference system that is not the metre or not stated (a code of the EPSG registry alone states none).
/// Says nothing about units for a cloud without a system, or whose system is ignored.
std::vector<std::string> notes_on_inputs(const InputCloud& cloud, const Chain& chain);

/// Appends stages to a chain. `facts`: facts about the cloud of the chain. Throws UsageError for an unknown stage or
/// option, and for a stage knn, which may only begin a pipeline.
void append_to(Chain& chain, const std::vector<StageText>& stages, Facts facts);

/// Builds a chain like build_chain() of program/pipeline.h, for a cloud that is known by its facts or for an
/// InputCloud.
Chain build_chain(const std::vector<StageText>& stages, Facts facts, const std::vector<std::string>& keep,
                  const std::string& prefix);
Chain build_chain(const std::vector<StageText>& stages, const InputCloud& cloud,
                  const std::vector<std::string>& keep = {}, const std::string& prefix = "");

/// Returns a stage in its canonical text (canonical_stages).
std::string canonical_text(const ChainStage& stage, Presets presets);

/// Returns the neighbourhood as a stage, such as "knn(k=12)"; k is left out if it is unlimited or left to the
/// operators. If the rule of the neighbourhood has no options, as a rule of a user may, its meaning follows in words
/// that parse_pipeline() does not read.
std::string canonical_text(const Neighborhood& neighborhood, Presets presets);

/// Returns the canonical stages of a plan; "sort" if it has no passes, "convert" if its chain has no stages.
std::vector<std::string> canonical_stages(const ChainPlan& plan, Presets presets);

/// Returns the pipeline with the absolute names of the files, folders and patterns that its options name. An option
/// whose file, or whose folder before the first wildcard, does not exist stays unchanged, since it may be a text, and
/// so does a stage of an unknown name. Throws the errors of parse_pipeline().
std::string with_absolute_files(std::string_view pipeline);

}  // namespace pointsweep
