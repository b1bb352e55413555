// SPDX-License-Identifier: MIT
/// Takes the points in their order through the stages of a pass.
#include <algorithm>
#include <numeric>
#include <optional>
#include <vector>

#include "pointsweep/pipeline/observation.h"
#include "pointsweep/pipeline/output/result_sinks.h"
#include "pointsweep/pipeline/rows/in_order_pass.h"
#include "pointsweep/pipeline/rows/nonfinite_points.h"
#include "pointsweep/pipeline/rows/pointwise_stages.h"
#include "pointsweep/pipeline/run/connect_points.h"
#include "pointsweep/pipeline/run/phases.h"
#include "pointsweep/pipeline/run/run_scratch.h"
#include "pointsweep/row_error.h"
#include "pointsweep/sweep/sweep.h"

namespace pointsweep {
namespace {

/// The records in `results` are whole output records by place in the stream, and not result records by row.
const OutputLayout* layout_of_results(const RunState& run, std::size_t p) {
  return run.makes_output(p) ? &*run.layout : nullptr;
}

std::function<void(std::uint64_t, std::uint64_t)> sweep_progress(const RunState& run) {
  return [&run](std::uint64_t read, std::uint64_t active) { run.report("sweeping", read, active); };
}

SweepOptions sweep_options(const RunState& run, const MemoryPlan& memory) {
  const bool first = run.statistics.sweeps == 0;
  return {.cell_points = run.options.cell_points,
          .read_ahead = std::max(1u, run.statistics.threads / 2),
          .slabs_per_turn = memory.slabs_per_turn,
          .recall_bytes = memory.recall_bytes,
          .cells_bytes = run.options.search_again ? 0 : memory.cells_bytes,
          .lists_bytes = run.options.lists_bytes != 0 ? run.options.lists_bytes : memory.lists_bytes,
          .count_distances = first && run.options.count_distances,
          .progress = sweep_progress(run)};
}

SweepStatistics sweep_by_cells(RunState& run, std::size_t p) {
  const SweepPlan& plan = run.plan.passes[p].plan;
  InputOrderSink by_row(*run.results, plan.result_bytes);
  std::optional<SweepOrderSink> by_place;
  if (const OutputLayout* layout = layout_of_results(run, p))
    by_place.emplace(*run.results, *run.stream, *layout, run.cloud.schema().stride);
  const bool notes = run.statistics.sweeps == 0 && !run.options.half_way_states.empty();
  std::vector<PointState> half_way(notes ? run.cloud.count() : 0);
  std::optional<CheckpointKeeper> keeper;
  std::optional<SweepProgress> from;
  const bool connects = run.plan.passes[p].connecting_stage() != nullptr;  // then it begins again
  if (run.checkpoints && !connects) keeper.emplace(*run.checkpoints, *run.results), from = run.checkpoints->progress();
  SweepOptions options = sweep_options(run, run.memory.passes[p]);
  options.half_way = notes ? &half_way : nullptr;
  options.keeper = keeper ? &*keeper : nullptr;
  options.resume_from = from ? &*from : nullptr;
  Sink& sink = by_place ? static_cast<Sink&>(*by_place) : by_row;
  const SweepStatistics done = connects ? sweep_and_connect(run, p, options) : sweep(*run.stream, plan, sink, options);
  if (notes) write_states(half_way, run.options.half_way_states, run.options.overwrite);
  return done;
}

SweepStatistics sweep_by(const SweepEngine& engine, RunState& run, std::size_t p) {
  const MemoryPlan& memory = run.memory.passes[p];
  const std::uint64_t others = memory.expected_bytes - memory.window_bytes;
  const std::uint64_t budget = run.statistics.memory_budget_bytes;
  return engine.sweep({.stream = *run.stream,
                       .pass = run.plan.passes[p],
                       .store = *run.results,
                       .layout = layout_of_results(run, p),
                       .memory_bytes = budget - std::min(budget, others),
                       .progress = sweep_progress(run)},
                      run.statistics);
}

/// Stores the results of points that are in no slab. They come last in the order of the stream.
void put_nonfinite(RunState& run, std::size_t p) {
  const PlannedPass& pass = run.plan.passes[p];
  const OutputLayout* layout = layout_of_results(run, p);
  PointwiseStages stages(pass, run.stream->record_schema());
  for_each_nonfinite(*run.stream, [&](std::uint64_t first, std::span<const std::byte> records) {
    std::vector<std::uint64_t> rows = rows_of_records(*run.stream, records);
    std::vector<std::byte> made(rows.size() * pass.plan.result_bytes);
    stages.run(records.data(), rows, made.data());
    if (layout == nullptr) return run.results->put(rows, made);
    const std::size_t from = run.stream->record_schema().stride, to = layout->schema().stride;
    std::vector<std::byte> output(rows.size() * to);
    for (std::size_t i = 0; i < rows.size(); ++i)
      layout->assemble(records.data() + i * from, made.data() + i * pass.plan.result_bytes, 1, output.data() + i * to,
                       {rows[i]});
    std::iota(rows.begin(), rows.end(), run.cloud.count() - run.stream->nonfinite_count() + first);
    run.results->put(rows, output);
  });
}

void sweep_stages(RunState& run, std::size_t p) {
  const std::size_t before = run.statistics.degenerate_results.size();
  FirstRowError refused;
  refused.note_from([&] {
    const SweepEngine* const other = run.other_engine();
    const SweepStatistics done = other ? sweep_by(*other, run, p) : sweep_by_cells(run, p);
    add_sweep(run.statistics, run.plan.passes[p].plan, done);
    if (run.stream->spilled_bytes() != 0) run.statistics.bytes_read += done.recalled_bytes;
  });
  refused.note_from([&] { put_nonfinite(run, p); });
  refused.throw_if_any();
  run.number_degenerate_rows(before);
}

void take_in_order(RunState& run, std::size_t p) {
  const PlannedPass& pass = run.plan.passes[p];
  const auto start = std::chrono::steady_clock::now();
  RunScratch scratch(run);
  const auto other_points = [&](const auto& take) {
    const auto report = [&](std::uint64_t rows) { run.report("ordering", rows, 0); };
    run.others[p]->give_in_order(run.stream->axis(), &scratch.folder(), report, take);
  };
  run_in_order({.stream = *run.stream,
                .pass = pass,
                .setup = {.axis = run.stream->axis(),
                          .memory_bytes = run.memory.passes[p].in_order_bytes,
                          .make_scratch = scratch.make(),
                          .other_points = other_points},
                .results = *run.results,
                .progress = [&run](std::uint64_t done) { run.report("updating", done, 0); }});
  put_nonfinite(run, p);
  run.statistics.operator_seconds.emplace_back(pass.in_order()->name(), seconds_since(start));
}

}  // namespace

void sweep_phase(RunState& run, std::size_t p) {
  PlannedPass& pass = run.plan.passes[p];
  pass.bind(run.stream->record_schema());
  pass.kind == PassKind::order ? take_in_order(run, p) : sweep_stages(run, p);
  run.statistics.bytes_spilled += run.stream->spilled_bytes();
  run.statistics.bytes_spilled_ordering += run.stream->spilled_bytes();
  run.stream.reset();  // nothing is read from it any more
}

}  // namespace pointsweep
