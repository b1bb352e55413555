// SPDX-License-Identifier: MIT
/// The first phase: decodes inputs that are slow to decode (FileInfo::decode_once), surveys the input, and makes the
/// WorkPlan.
#include "pointsweep/pipeline/output/output_formats.h"
#include "pointsweep/pipeline/rows/input_source.h"
#include "pointsweep/pipeline/run/output_files.h"
#include "pointsweep/pipeline/run/phases.h"
#include "pointsweep/pipeline/sweep_engine.h"

namespace pointsweep {
namespace {

bool needs_exact_survey(const Context& context) {
  const std::vector<PlannedPass>& passes = context.plan.passes;
  const bool orders_first = passes.empty() || (passes.front().kind == PassKind::order && !passes.front().has_places());
  return orders_first || context.options.order == Order::sweep || engine_of(context.options.engine) != nullptr ||
         needs_bounds(context);
}

}  // namespace

InputCloud decode_input(const Context& context, OutputFiles& files) {
  const std::uint64_t bytes = decoded_input_bytes(context.cloud);
  if (context.copies_rows || bytes == 0) return context.cloud;
  if (!context.outputs.writer) files.require_writable(context, {});
  const auto start = std::chrono::steady_clock::now();
  InputCloud decoded = decoded_input(context.cloud, context.options, context.places.place("decoded", 0, true));
  context.statistics().bytes_spilled += bytes;
  context.statistics().bytes_spilled_decoding = bytes;
  context.statistics().order_seconds += seconds_since(start);
  return decoded;
}

Survey survey_points(const Context& context, const PointSource& source, bool exact) {
  const auto start = std::chrono::steady_clock::now();
  Survey found = survey(source, context.options.axis, exact);
  context.statistics().order_seconds += seconds_since(start);
  return found;
}

Survey survey_input(const Context& context) {
  if (context.copies_rows) return {};
  const Checkpoints* const checkpoints = context.places.checkpoints();
  Survey found = checkpoints != nullptr && checkpoints->found()
                     ? checkpoints->last().survey
                     : survey_points(context, context.cloud_source(), needs_exact_survey(context));
  if (!context.plan.passes.empty()) require_distances(found.bounds);
  return found;
}

WorkPlan plan_work(const Context& context, Surveyed& input) {
  const InputCloud& cloud = context.cloud;
  const ChainPlan& plan = context.plan;
  const RunReport& report = context.report;
  WorkPlan work{.layout = {}, .budget = report.statistics.memory_budget_bytes, .memory = {}};
  OnDemandOrder on_demand = on_demand_order(cloud, plan, context.options);
  if (!plan.passes.empty()) work.layout = layout_of_output(cloud, context.names, context.outputs, context.options);
  const std::uint64_t record = work.layout ? work.layout->schema().stride : cloud.schema().stride;
  const auto codecs = [&](unsigned threads) { return context.codec_bytes(record, threads); };
  work.memory =
      plan_run_memory(work.budget, plan, cloud.count(), input.survey, context.options, record, codecs, on_demand);
  input.boxes = std::move(on_demand.boxes);
  report.statistics.threads = work.memory.threads;
  if (!work.memory.threads_note.empty()) report.note(work.memory.threads_note);
  return work;
}

}  // namespace pointsweep
