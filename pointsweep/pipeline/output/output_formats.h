// SPDX-License-Identifier: MIT
/// The formats of the point files that a run writes, the names of made attributes in these files, and checks of the
/// outputs before the work. No made attribute overwrites an attribute of the input by accident.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pointsweep/attribute.h"
#include "pointsweep/crs.h"
#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/formats/format.h"
#include "pointsweep/formats/known_values.h"
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
  std::vector<Attribute> made;        ///< the made attributes; their fields have the names in the output
  KeptFields kept;                    ///< the kept fields, with the names in the output
  std::vector<std::string> replaced;  ///< attributes of the input that a made attribute overwrites without `replace`
  /// Returns "replacing nx, ny, nz of the input with computed values."; empty if no attribute is replaced.
  std::string warning() const;
};

/// Returns the names of made and kept attributes in `output`, whose format may shorten names. A made attribute
/// overwrites an attribute of the input, of one value a point, if `replace` names it, or if its name has no other
/// meaning (means_only()): the input has nx ny nz or NormalX, and the user asks for normals. Throws UsageError for
/// other conflicts of names, and for a name in `replace` that no made attribute overwrites. An example is `curvature`:
/// some programs store the surface variation under this name, others a curvature. With a prefix only attributes in
/// `replace` are overwritten. Made positions have no prefix. Colours of the input are overwritten only if `replace`
/// names them.
OutputNames name_outputs(const Schema& input, const std::string& input_name, const std::vector<Attribute>& made,
                         const KeptFields& kept, const std::filesystem::path& output, const NamingRules& rules);

/// A format of the outputs, with one output file of this format.
struct OutputFormat {
  const Format* format;
  std::filesystem::path example;  ///< the first output of that format
};
/// Returns each format of the point files (Outputs::points and Outputs::tiles) once. Throws UsageError for a file name
/// whose format cannot be written.
std::vector<OutputFormat> output_formats(const Outputs& outputs);

/// Returns whether `format`, the format of an output or null, needs OutputPlan::bounds before records of `schema` are
/// written.
bool needs_bounds(const Format* format, const Schema& schema, const FileLayout& layout);

/// Returns the facts about all values that the format of an output needs before the first record; null if the format
/// needs none or `format` is null. `progress`: see Format::values.
std::shared_ptr<KnownValues> values_if_needed(const Format* format, InputCloud& cloud, const FileLayout& layout,
                                              const std::function<void(std::uint64_t rows)>& progress);

/// Returns the names of made attributes in all outputs (name_outputs()). Throws the errors of name_outputs() for each
/// format of the outputs.
OutputNames names_in_outputs(const InputCloud& cloud, const ChainPlan& plan, const Outputs& outputs,
                             const EngineOptions& options);

/// Throws UsageError if the run would write nothing.
void require_outputs(const Outputs& outputs);

/// Throws UsageError for a format whose writer changes the order of points (Format::reorders).
void require_order_kept(const Outputs& outputs);

/// Throws UsageError for Outputs::tiles together with another destination or with Order::sweep, for Order::sweep in a
/// format that changes the order, for options of FileLayout that the format of an output does not support, and for a
/// division among files that is impossible. Throws Error if the folder of a division holds point files of any name and
/// the run may not overwrite files.
void require_outputs_possible(const Outputs& outputs, const EngineOptions& options);

/// Returns the requirements of the outputs on the plan of a chain.
OutputNeeds needs_of(const Outputs& outputs, const EngineOptions& options);

/// Returns the name of the output in a sentence: the point file, the folder of tiles or of a divided output, "standard
/// output", or "the output".
std::string name_of_output(const Outputs& outputs);

/// Returns a warning if a stage assigns coordinates, or an operator of a user makes them, while an output states the
/// coordinate system of the input. Other operators of the library move points within their system. A change of z alone
/// matters only if the system defines heights. Empty if no warning is needed, as when the user states the system.
std::string kept_system_warning(const ChainPlan& plan, const InputCloud& cloud, const Outputs& outputs);

}  // namespace pointsweep
