// SPDX-License-Identifier: MIT
/// The phase that takes the points in order through the stages of a pass.
#include <algorithm>
#include <numeric>
#include <optional>
#include <vector>

#include "pointsweep/pipeline/output/result_sinks.h"
#include "pointsweep/pipeline/rows/in_order_pass.h"
#include "pointsweep/pipeline/rows/nonfinite_points.h"
#include "pointsweep/pipeline/rows/pointwise_stages.h"
#include "pointsweep/pipeline/run/phases.h"
#include "pointsweep/pipeline/statistics.h"
#include "pointsweep/pipeline/sweep_engine.h"
#include "pointsweep/row_error.h"

namespace pointsweep {
namespace {

/// A pass that takes points in order, and the place for its results.
struct SweepOfPass {
  const Context& context;
  const WorkPlan& work;
  const PlannedPass& pass;  ///< result of ready_pass() for the records of the stream
  const Ordered& points;
  /// Layout of whole output records if `results` stores output records by place in the stream. Null if `results` stores
  /// result records by row.
  const OutputLayout* layout;
  bool is_first;  ///< true for the first sweep of the run
  RowStore& results;
  const PassSupport& support;
};

std::function<void(std::uint64_t, std::uint64_t)> sweep_progress(const Context& context) {
  return [&context](std::uint64_t read, std::uint64_t active) { context.progress("sweeping", read, active); };
}

SweepOptions sweep_options(const SweepOfPass& s) {
  const EngineOptions& options = s.context.options;
  const MemoryPlan& memory = s.points.memory;
  return {.cell_points = options.cell_points,
          .read_ahead = std::max(1u, s.work.memory.threads / 2),
          .slabs_per_turn = memory.slabs_per_turn,
          .recall_bytes = memory.recall_bytes,
          .spare_bytes = s.work.spare_bytes(),
          .cells_bytes = options.search_again ? 0 : memory.cells_bytes,
          .lists_bytes = options.lists_bytes != 0 ? options.lists_bytes : memory.lists_bytes,
          .count_distances = s.is_first && options.count_distances,
          .progress = sweep_progress(s.context)};
}

SweepStatistics sweep_by_cells(const SweepOfPass& s) {
  const Context& context = s.context;
  InputOrderSink by_row(s.results, s.pass.plan.result_bytes, s.points.first_row);
  std::optional<SweepOrderSink> by_place;
  if (s.layout != nullptr) by_place.emplace(s.results, s.points.stream, *s.layout, context.cloud.schema().stride);
  const bool notes = s.is_first && !context.options.half_way_states.empty();
  std::vector<PointState> half_way(notes ? context.cloud.count() : 0);
  std::optional<CheckpointKeeper> keeper;
  std::optional<SweepProgress> from;
  // The sweep of a connecting stage has no checkpoints, so a resumed run repeats it.
  const bool connects = s.pass.connecting_stage() != nullptr;
  if (Checkpoints* const checkpoints = context.places.checkpoints(); checkpoints != nullptr && !connects)
    keeper.emplace(*checkpoints, s.results), from = checkpoints->progress();
  SweepOptions options = sweep_options(s);
  options.half_way = notes ? &half_way : nullptr;
  options.keeper = keeper ? &*keeper : nullptr;
  options.resume_from = from ? &*from : nullptr;
  Sink& sink = by_place ? static_cast<Sink&>(*by_place) : by_row;
  const auto connect = [&] {
    if (s.support.graph.scratch == nullptr) return sweep_and_connect(context, s.pass, s.points, options, s.results);
    return sweep_and_leave_graph(context, s.pass, s.points, options, s.support.graph, s.results);
  };
  const SweepStatistics done = connects ? connect() : sweep(s.points.stream, s.pass.plan, sink, options);
  if (notes) write_states(half_way, context.options.half_way_states, context.options.overwrite);
  return done;
}

SweepStatistics sweep_by(const SweepEngine& engine, const SweepOfPass& s) {
  const std::uint64_t others = s.points.memory.expected_bytes - s.points.memory.window_bytes;
  return engine.sweep({.stream = s.points.stream,
                       .pass = s.pass,
                       .store = s.results,
                       .layout = s.layout,
                       .memory_bytes = s.work.budget - std::min(s.work.budget, others),
                       .progress = sweep_progress(s.context)},
                      s.context.statistics());
}

/// Stores the results of nonfinite points, which belong to no slab and come last in the order of the stream.
void put_nonfinite(const SweepOfPass& s) {
  const Stream& stream = s.points.stream;
  const std::size_t result_bytes = s.pass.plan.result_bytes;
  PointwiseStages stages(s.pass, stream.record_schema());
  for_each_nonfinite(stream, [&](std::uint64_t first, std::span<const std::byte> records) {
    std::vector<std::uint64_t> rows = rows_of_records(stream, records);
    std::vector<std::byte> made(rows.size() * result_bytes);
    stages.run(records.data(), rows, made.data());
    for (std::uint64_t& row : rows) row -= s.points.first_row;
    if (s.layout == nullptr) return s.results.put(rows, made);
    const std::size_t from = stream.record_schema().stride, to = s.layout->schema().stride;
    std::vector<std::byte> output(rows.size() * to);
    for (std::size_t i = 0; i < rows.size(); ++i)
      s.layout->assemble(records.data() + i * from, made.data() + i * result_bytes, 1, output.data() + i * to,
                         {rows[i]});
    std::iota(rows.begin(), rows.end(), s.context.cloud.count() - stream.nonfinite_count() + first);
    s.results.put(rows, output);
  });
}

/// Throws the error of the lowest row with an error, if there is one. The thrown error counts rows from `first_row`.
void throw_refused(const FirstRowError& refused, std::uint64_t first_row) {
  try {
    refused.throw_if_any();
  } catch (const RowError& error) {
    throw error.numbered(error.row() - first_row);
  }
}

void sweep_stages(const SweepOfPass& s) {
  Statistics& statistics = s.context.statistics();
  const std::size_t before = statistics.degenerate_results.size();
  FirstRowError refused;
  refused.note_from([&] {
    const SweepEngine* const other = engine_of(s.context.options.engine);
    const SweepStatistics done = other ? sweep_by(*other, s) : sweep_by_cells(s);
    add_sweep(statistics, s.pass.plan, done);
    if (s.points.stream.spilled_bytes() != 0) statistics.bytes_read += done.recalled_bytes;
  });
  refused.note_from([&] { put_nonfinite(s); });
  throw_refused(refused, s.points.first_row);
  for (std::size_t r = before; r < statistics.degenerate_results.size(); ++r)
    for (std::uint64_t& row : statistics.degenerate_results[r].rows) row -= s.points.first_row;
  s.context.number_degenerate_rows(before);
}

void take_in_order(const SweepOfPass& s) {
  const auto start = std::chrono::steady_clock::now();
  const Context& context = s.context;
  const int axis = s.points.stream.axis();
  FirstRowError refused;
  std::string warning;
  refused.note_from([&] {
    warning = run_in_order({.stream = s.points.stream,
                            .pass = s.pass,
                            .setup = {.axis = axis,
                                      .memory_bytes = s.points.memory.in_order_bytes,
                                      .make_scratch = context.places.scratch(),
                                      .other_points = [&](const auto& take) { s.support.other(axis, take); },
                                      .may_lack = s.support.may_lack},
                            .is_part = context.part.has_value(),
                            .first_row = s.points.first_row,
                            .rows = context.cloud.count(),
                            .results = s.results,
                            .undecided = s.support.undecided,
                            .progress = context.progress_of("updating")});
  });
  throw_refused(refused, s.points.first_row);
  put_nonfinite(s);
  if (!warning.empty() && !context.part) context.report.warn(s.pass.in_order()->name() + ": " + warning);
  context.statistics().operator_seconds.emplace_back(s.pass.in_order()->name(), seconds_since(start));
}

}  // namespace

std::unique_ptr<RowStore> results_of_pass(const Context& context, const WorkPlan& work, const MemoryPlan& memory,
                                          std::size_t p) {
  const PlannedPass& pass = context.plan.passes[p];
  const std::size_t bytes = context.makes_output(p) ? work.layout->schema().stride : pass.plan.result_bytes;
  const std::vector<std::byte> fill = pass.in_order() != nullptr ? pass.fill_record() : std::vector<std::byte>(bytes);
  const SpillPlace spill = context.places.place("results", p, memory.spill_results);
  const std::uint64_t rows = context.cloud.count(), buffer = memory.result_buffer_bytes;
  const Checkpoints* const checkpoints = context.places.checkpoints();
  if (checkpoints == nullptr || checkpoints->last().results.empty())
    return std::make_unique<RowStore>(rows, fill, spill, buffer);
  Decoder in(checkpoints->last().results);
  auto results = std::make_unique<RowStore>(in, rows, fill, spill, buffer);
  in.finish();
  return results;
}

std::unique_ptr<RowStore> sweep_pass(const Context& context, const WorkPlan& work, std::size_t p,
                                     std::unique_ptr<Ordered> points, const CloudValues& values,
                                     const PassSupport& support) {
  const auto& passes = context.plan.passes;
  const PlannedPass pass = ready_pass(passes[p], values, points->stream.record_schema());
  std::unique_ptr<RowStore> results = results_of_pass(context, work, points->memory, p);
  const bool is_first =
      std::ranges::find(passes, PassKind::sweep, &PlannedPass::kind) - passes.begin() == static_cast<std::ptrdiff_t>(p);
  const SweepOfPass s{context,  work,     pass,   *points, context.makes_output(p) ? &*work.layout : nullptr,
                      is_first, *results, support};
  pass.kind == PassKind::order ? take_in_order(s) : sweep_stages(s);
  context.statistics().bytes_spilled += points->stream.spilled_bytes();
  context.statistics().bytes_spilled_ordering += points->stream.spilled_bytes();
  return results;
}

}  // namespace pointsweep
