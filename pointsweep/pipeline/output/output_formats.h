// SPDX-License-Identifier: MIT
/// The formats of the point files that a run writes, and the names that made attributes get in them: none takes the
/// name of an attribute of the input by accident.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pointsweep/attribute.h"
#include "pointsweep/crs.h"
#include "pointsweep/formats/format.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/pipeline/plan/kept_fields.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {

/// The rules for names of made attributes: EngineOptions::prefix and EngineOptions::replace.
struct NamingRules {
  std::string prefix;
  std::vector<std::string> replace;
};

struct OutputNames {
  std::vector<Attribute> made;        ///< those that were given, their fields with the names in the output
  KeptFields kept;                    ///< likewise
  std::vector<std::string> replaced;  ///< attributes of the input that are overwritten unasked: they bear the very name
  /// "The input's attributes nx ny nz are replaced ..."; empty if there are none.
  std::string warning() const;
};

/// An attribute of the input is overwritten where an operator makes one of the very name (an input with nx ny nz, and
/// normals are made: a user who asks for normals asks for that), and where `replace` names it. Any other that would
/// lose its name to a made one is refused with UsageError: above all `curvature`, which several programs call the
/// surface variation and others a curvature. With a prefix nothing is overwritten unless `replace` names it. Positions
/// move without prefix. Colours of the input are never replaced unasked. `output` tells the format, in which names may
/// be shortened.
OutputNames name_outputs(const Schema& input, const std::string& input_name, const std::vector<Attribute>& made,
                         const KeptFields& kept, const std::filesystem::path& output, const NamingRules& rules);

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

/// Throws UsageError for a format whose writer puts points in another order (Format::reorders).
void require_order_kept(const Outputs& outputs);

/// Throws UsageError for a request that only one output of all points can fulfil, if there are tiles, and for a wish
/// about the layout of files (FileLayout) that the format of an output has no place for.
void require_outputs_possible(const Outputs& outputs, const EngineOptions& options);

/// Returns the requirements of the outputs on the plan of a chain.
OutputNeeds needs_of(const Outputs& outputs, const EngineOptions& options);

/// Returns the name of the output in a sentence: the point file, the folder of the first tile, or "the output".
std::string name_of_output(const Outputs& outputs);

/// A warning where a stage assigns other coordinates, or an operator of a user makes them, and an output states the
/// system of the input all the same; empty where none is needed. The library's other operators move points within
/// their system. Other heights alone matter only where the system defines heights.
std::string kept_system_warning(const ChainPlan& plan, const InputCloud& cloud, const Outputs& outputs);

}  // namespace pointsweep
