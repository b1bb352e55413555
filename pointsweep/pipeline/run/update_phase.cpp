// SPDX-License-Identifier: MIT
/// The phase that ends a pass: its results become the rows, and the values of the whole cloud, with which the next pass
/// begins.
#include <algorithm>

#include "pointsweep/cancellation.h"
#include "pointsweep/pipeline/rows/pass_update.h"
#include "pointsweep/pipeline/rows/pointwise_stages.h"
#include "pointsweep/pipeline/run/phases.h"
#include "pointsweep/pipeline/statistics.h"

namespace pointsweep {
namespace {

void note_rows_pass(const Context& context, const SweepPlan& plan, const StageTally& tally) {
  const std::size_t before = context.statistics().degenerate_results.size();
  add_stages(context.statistics(), plan, tally.seconds, tally.degenerate);
  context.number_degenerate_rows(before);
}

/// Returns rows without made values, for a pass without stages, which only reduces its rows to values of the whole
/// cloud.
MadeRows nothing_made(std::uint64_t count) {
  return [count](const auto& use) {
    constexpr std::uint64_t kRows = 1 << 16;
    for (std::uint64_t row = 0; row < count; row += kRows) {
      stop_if_cancelled();
      use(row, static_cast<std::size_t>(std::min(kRows, count - row)), nullptr);
    }
  };
}

}  // namespace

PointSource source_of_pass(const Context& context, std::size_t p, const Rows& before) {
  const bool nothing_carried = p == 0 || context.plan.passes[p - 1].carried.empty();
  return nothing_carried ? context.cloud_source()
                         : updated_source(context.cloud_source(), *before.carried, context.plan.passes[p]);
}

MadeRows made_by_pass(const Context& context, std::size_t p, const Rows& before, RowStore* results) {
  const PlannedPass& planned = context.plan.passes[p];
  if (planned.kind == PassKind::rows && planned.plan.stages.empty()) return nothing_made(context.cloud.count());
  if (planned.kind == PassKind::rows)
    return [&context, &planned, &before, p](const auto& use) {
      const PlannedPass pass = ready_pass(planned, before.values, planned.input);
      note_rows_pass(context, pass.plan, run_rows(pass, source_of_pass(context, p, before), use));
    };
  return [results, bytes = planned.plan.result_bytes](const auto& use) {
    results->drain(
        [&](std::uint64_t first, std::span<const std::byte> made) { use(first, made.size() / bytes, made.data()); });
  };
}

RowUpdate update_after(const ChainPlan& plan, std::size_t p) {
  const std::vector<Attribute> none;
  const PlannedPass& pass = plan.passes[p];
  return {p == 0 ? none : plan.passes[p - 1].carried, pass.made, pass.carried};
}

Rows update_pass(const Context& context, const WorkPlan& work, std::size_t p, Rows before,
                 std::unique_ptr<RowStore> results) {
  const auto start = std::chrono::steady_clock::now();
  const PlannedPass& pass = context.plan.passes[p];
  const RowUpdate after = update_after(context.plan, p);
  const bool spills = work.memory.spill_rows;
  PassUpdate to(pass, context.cloud, context.cloud_source(), context.places.place("rows", p + 1, spills),
                context.places.place("mask", p + 1, spills));
  update_rows(made_by_pass(context, p, before, results.get()), before.carried.get(), after,
              [&](const UpdatedRows& rows) {
                to.add(rows);
                context.progress("updating", rows.first + rows.count);
              });
  Rows left;
  left.values = std::move(before.values);
  if (context.part) left.saved_values = to.saved_values();
  left.carried = to.finish(left.values);
  left.cloud = std::move(before.cloud);
  if (std::optional<RowSelection> kept = to.take_selection())
    left.cloud = std::make_shared<InputCloud>(left.cloud->selected(std::move(*kept)));
  context.statistics().bytes_spilled += to.spilled_bytes() + (results ? results->spilled_bytes() : 0);
  context.statistics().write_seconds += seconds_since(start);
  return left;
}

}  // namespace pointsweep
