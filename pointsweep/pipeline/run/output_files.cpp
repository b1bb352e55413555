// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/run/output_files.h"

#include <set>
#include <string>
#include <vector>

#include "pointsweep/formats/known_values.h"
#include "pointsweep/formats/registry.h"
#include "pointsweep/pipeline/canonical_text.h"
#include "pointsweep/pipeline/provenance_record.h"
#include "pointsweep/pipeline/run/survey_input.h"

namespace pointsweep {
namespace {

/// Whether an attribute is not written because of Chain::keep.
bool leaves_out(const ChainPlan& plan) {
  std::set<std::string> made;
  for (const ChainStage& stage : plan.chain.stages)
    if (const Contract contract = contract_of(stage); contract.selects == Selects::nothing)
      for (const Attribute& a : contract.makes) made.insert(a.name);
  return plan.kept.input || !plan.kept.left_out.empty() || plan.kept.attributes.size() < made.size();
}

std::vector<std::string> provenance(const RunState& run) {
  const std::vector<std::string> stages = canonical_stages(run.plan, Presets::left_out);
  return provenance_of(run.cloud, stages, leaves_out(run.plan) ? run.plan.chain.keep : std::vector<std::string>{},
                       run.options, run.survey.axis, run.statistics.dropped > 0);
}

/// What the format of the output has to know of all values before the first record.
std::shared_ptr<const KnownValues> values_if_needed(RunState& run) {
  const Format* const format = format_of_output(run.outputs.points);
  if (format == nullptr || format->values == nullptr) return nullptr;
  const auto report = [&run](std::uint64_t rows) { run.report("ordering", rows, 0); };
  return std::make_shared<KnownValues>(format->values(run.cloud, report));
}

std::optional<Box> bounds_if_known(const RunState& run) {
  if (const Box& box = run.input.dropped().bounds; !box.empty() && !run.cloud.selection()) return box;
  if (run.is_empty()) return Box{Vec3{}, Vec3{}};
  return run.survey.exact && !run.survey.bounds.empty() ? std::optional(run.survey.bounds) : std::nullopt;
}

void open_files(RunState& run) {
  run.files.emplace(run.cloud, run.names.made, run.names.kept, run.outputs, run.options, bounds_if_known(run),
                    provenance(run), values_if_needed(run));
}

}  // namespace

void require_writable(const RunState& run) {
  Box somewhere = run.survey.bounds;
  if (somewhere.empty()) somewhere.include(Vec3{});
  OutputSet(run.cloud, run.names.made, run.names.kept, run.outputs, run.options, somewhere);
}

bool needs_bounds(const RunState& run) {
  const Format* const format = format_of_output(run.outputs.points);
  return format != nullptr && format->needs_bounds != nullptr &&
         (run.input.dropped().bounds.empty() || run.cloud.selection()) && format->needs_bounds(run.cloud.schema());
}

void open_outputs(RunState& run) { run.plan.selects() ? require_writable(run) : open_files(run); }

void open_late(RunState& run) {
  if (needs_bounds(run) && !run.is_empty()) {
    run.source = run.cloud_source();
    const int axis = run.survey.axis;
    survey_source(run, true);
    run.survey.axis = axis;
  }
  run.statistics.points_written = run.cloud.count();
  if (run.is_empty()) run.warn(fmt::format("No point is left: {} holds none.", run.outputs.points.string()));
  open_files(run);
}

}  // namespace pointsweep
