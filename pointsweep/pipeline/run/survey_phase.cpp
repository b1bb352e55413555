// SPDX-License-Identifier: MIT
/// The first phase: the input is surveyed, and everything is decided that the work needs.
#include <algorithm>

#include "pointsweep/pipeline/memory/radius_estimate.h"
#include "pointsweep/pipeline/run/output_files.h"
#include "pointsweep/pipeline/run/phases.h"
#include "pointsweep/pipeline/run/survey_input.h"

namespace pointsweep {
namespace {

/// Says which pass takes longest where all of them take long.
void give_notice(const RunState& run) {
  double seconds = 0;
  for (const Effort& effort : run.memory.efforts) seconds += effort.seconds;
  if (seconds < kLongSeconds || run.options.observer == nullptr) return;
  const Effort& most = *std::ranges::max_element(run.memory.efforts, {}, &Effort::seconds);
  run.options.observer->on_note(
      fmt::format("{} means {}, {}; {}.", most.cause, most.text, about_time_text(seconds), most.remedy));
}

bool needs_exact_survey(const RunState& run) {
  const std::vector<PlannedPass>& passes = run.plan.passes;
  const bool orders_first = passes.empty() || (passes.front().kind == PassKind::order && !passes.front().has_places());
  return orders_first || run.options.order == Order::sweep || run.other_engine() != nullptr || needs_bounds(run);
}

/// Refuses first what can be refused without the work.
void decode_input(RunState& run) {
  if (decoded_input_bytes(run.cloud) == 0) return;
  if (!run.outputs.writer) require_writable(run);
  const auto start = std::chrono::steady_clock::now();
  if (!run.checkpoints) run.folder.emplace(temp_parent(run.options.resources.temp_folder));
  run.decoded.emplace(run.cloud, run.options, [&](std::size_t input) { return run.place("decoded", input, true); });
  run.statistics.bytes_spilled += run.decoded->bytes();
  run.statistics.bytes_spilled_decoding = run.decoded->bytes();
  run.statistics.order_seconds += seconds_since(start);
}

void plan_memory_of(RunState& run) {
  const Schema& input = run.cloud.schema();
  run.on_demand = on_demand_order(run.cloud, run.plan, run.options);
  if (!run.plan.passes.empty())
    run.layout.emplace(input, run.names.made, run.names.kept,
                       type_of_positions(run.names.made, run.outputs.points, run.options));
  const std::uint64_t output = run.layout ? run.layout->schema().stride : input.stride;
  const auto codecs = [&](unsigned threads) { return codec_bytes(run.cloud, run.outputs, output, threads); };
  run.memory = plan_run_memory(run.statistics.memory_budget_bytes, run.plan, run.cloud.count(), run.survey, run.options,
                               output, codecs, run.on_demand);
  run.statistics.threads = run.memory.threads;
  if (!run.memory.threads_note.empty()) run.note(run.memory.threads_note);
}

void make_folder(RunState& run) {
  if (!run.memory.spills() || run.checkpoints || run.folder) return;
  run.folder.emplace(temp_parent(run.options.resources.temp_folder));
}

}  // namespace

void survey_source(RunState& run, bool exact) {
  const auto start = std::chrono::steady_clock::now();
  run.survey = survey(run.source, run.options.axis, exact);
  run.statistics.order_seconds += seconds_since(start);
}

void survey_phase(RunState& run) {
  decode_input(run);
  run.source = run.cloud_source();
  if (run.checkpoints && run.checkpoints->found())
    run.survey = run.checkpoints->last().survey;
  else
    survey_source(run, needs_exact_survey(run));
  if (!run.plan.passes.empty()) require_distances(run.survey.bounds);
  plan_memory_of(run);
}

void open_run(RunState& run) {
  open_outputs(run);
  give_notice(run);
  make_folder(run);
}

}  // namespace pointsweep
