// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/run/made_rows.h"

#include <algorithm>

#include "pointsweep/cancellation.h"
#include "pointsweep/pipeline/rows/row_pass.h"

namespace pointsweep {
namespace {

void note_rows_pass(RunState& run, const SweepPlan& plan, const StageTally& tally) {
  const std::size_t before = run.statistics.degenerate_results.size();
  for (std::size_t i = 0; i < plan.stages.size(); ++i) {
    const std::string name = name_of(plan.stages[i].op);
    run.statistics.operator_seconds.emplace_back(name, tally.seconds[i]);
    run.statistics.degenerate_results.push_back({name, tally.degenerate[i].count(), tally.degenerate[i].lowest()});
    run.statistics.degenerate += tally.degenerate[i].count();
  }
  run.number_degenerate_rows(before);
}

/// Returns the rows of a pass without stages, which only serves to find values of its rows.
MadeRows nothing_made(const RunState& run) {
  return [&run](const auto& use) {
    constexpr std::uint64_t kRows = 1 << 16;
    for (std::uint64_t row = 0; row < run.cloud.count(); row += kRows) {
      stop_if_cancelled();
      use(row, static_cast<std::size_t>(std::min(kRows, run.cloud.count() - row)), nullptr);
    }
  };
}

MadeRows made_of_rows(RunState& run, PlannedPass& pass) {
  return [&run, &pass](const auto& use) {
    pass.bind(pass.input);
    RowPass rows(pass);
    rows.run(run.source, use);
    note_rows_pass(run, pass.plan, rows.tally());
  };
}

}  // namespace

std::unique_ptr<RowStore> results_of_pass(const RunState& run, std::size_t p) {
  const MemoryPlan& memory = run.memory.passes[p];
  const PlannedPass& pass = run.plan.passes[p];
  const std::size_t bytes = run.makes_output(p) ? run.layout->schema().stride : pass.plan.result_bytes;
  const std::vector<std::byte> fill = pass.in_order() != nullptr ? pass.fill_record() : std::vector<std::byte>(bytes);
  const SpillPlace spill = run.place("results", p, memory.spill_results);
  const std::uint64_t rows = run.cloud.count(), buffer = memory.result_buffer_bytes;
  if (!run.checkpoints || run.checkpoints->last().results.empty())
    return std::make_unique<RowStore>(rows, fill, spill, buffer);
  Unpacker packed(run.checkpoints->last().results);
  return std::make_unique<RowStore>(packed, rows, fill, spill, buffer);
}

MadeRows made_by_pass(RunState& run, std::size_t p) {
  PlannedPass& pass = run.plan.passes[p];
  if (pass.kind == PassKind::rows) return pass.plan.stages.empty() ? nothing_made(run) : made_of_rows(run, pass);
  return [&results = *run.results, bytes = pass.plan.result_bytes](const auto& use) {
    results.drain(
        [&](std::uint64_t first, std::span<const std::byte> made) { use(first, made.size() / bytes, made.data()); });
  };
}

RowUpdate update_after(const ChainPlan& plan, std::size_t p) {
  const std::vector<Attribute> none;
  const PlannedPass& pass = plan.passes[p];
  return {p == 0 ? none : plan.passes[p - 1].carried, pass.made, pass.carried};
}

}  // namespace pointsweep
