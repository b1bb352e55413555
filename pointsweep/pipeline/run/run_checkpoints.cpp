// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/run/run_checkpoints.h"

#include "pointsweep/fail.h"
#include "pointsweep/pipeline/checkpoint/run_identity.h"
#include "pointsweep/pipeline/rows/row_mask.h"
#include "pointsweep/pipeline/run/made_rows.h"

namespace pointsweep {
namespace {

/// The output that is put in order has no checkpoints.
bool is_of_reordering(const RunState& run, const Phase& phase) {
  return phase.pass == run.plan.passes.size() && !run.plan.passes.empty();
}

}  // namespace

void open_checkpoints(RunState& run) {
  if (run.options.resume_folder.empty()) return;
  if (run.other_engine() != nullptr || !run.options.half_way_states.empty())
    fail_usage("A run of the reference engine, or one that notes half-way states, cannot be resumed.");
  std::string identity = run_identity(run.cloud, run.plan, run.outputs, run.options);
  for (const std::optional<OtherCloud>& other : run.others)
    if (other) identity += other->identity();
  run.checkpoints.emplace(run.options, identity);
  if (!run.checkpoints->found()) return;
  take_counts(run.statistics, run.checkpoints->last().counts);
  if (run.options.resources.memory_bytes == 0)
    run.statistics.memory_budget_bytes = run.checkpoints->last().memory_bytes;
  run.note("Went on where an earlier process had ended: times and series are of this one alone.");
}

void restore_rows(RunState& run) {
  if (!run.checkpoints || run.checkpoints->last().sweep == 0) return;
  const Checkpoint& last = run.checkpoints->last();
  if (last.mask > 0) run.cloud.select(RowMask::kept(run.cloud.count(), run.checkpoints->place("mask", last.mask)));
  for (std::size_t v = 0; v < last.values.size(); ++v)
    if (!last.values[v].empty()) run.values[v] = last.values[v];
  const std::size_t bytes = update_after(run.plan, last.sweep - 1).record_bytes();
  run.rows =
      std::make_unique<RowFile>(RowFile::kept(run.cloud.count(), bytes, run.checkpoints->place("rows", last.sweep)));
}

bool is_done(const RunState& run, const Phase& phase) {
  if (!run.checkpoints || phase.kind == PhaseKind::survey) return false;
  const Checkpoint& last = run.checkpoints->last();
  if (phase.pass != last.sweep) return phase.pass < last.sweep;
  const bool before_results = phase.kind == PhaseKind::order || phase.kind == PhaseKind::sweep;
  return before_results && last.is_swept();
}

void checkpoint_after(RunState& run, const Phase& phase) {
  if (!run.checkpoints || is_of_reordering(run, phase)) return;
  switch (phase.kind) {
    case PhaseKind::survey:
      return run.checkpoints->surveyed(run.survey, run.statistics.memory_budget_bytes);
    case PhaseKind::order: {
      const MemoryPlan& memory = run.plan.passes.empty() ? run.memory.reordering : run.memory.passes[phase.pass];
      return run.checkpoints->in_order(*run.stream, memory.slab_points, run.bucket_places, run.results.get());
    }
    case PhaseKind::sweep:
      return run.checkpoints->swept(*run.results, run.statistics);
    case PhaseKind::update:
      return run.checkpoints->updated(run.plan.passes[phase.pass].selects, run.values, run.statistics);
    case PhaseKind::write:
      return;  // the run is complete: finish() removes them
  }
}

}  // namespace pointsweep
