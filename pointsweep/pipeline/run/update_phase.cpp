// SPDX-License-Identifier: MIT
/// Ends a pass: its results become the rows, and the values of the whole cloud, that the next pass begins with.
#include "pointsweep/pipeline/rows/pass_update.h"
#include "pointsweep/pipeline/run/made_rows.h"
#include "pointsweep/pipeline/run/phases.h"

namespace pointsweep {

void update_phase(RunState& run, std::size_t p) {
  const auto start = std::chrono::steady_clock::now();
  const PlannedPass& pass = run.plan.passes[p];
  const RowUpdate after = update_after(run.plan, p);
  const bool spills = run.memory.spill_rows;
  PassUpdate to(pass, run.cloud, run.cloud_source(), after.record_bytes(), run.place("rows", p + 1, spills),
                run.place("mask", p + 1, spills));
  update_rows(made_by_pass(run, p), run.rows.get(), after, pass.plan.result_bytes, [&](const UpdatedRows& rows) {
    to.add(rows);
    run.report("updating", rows.first + rows.count, 0);
  });
  run.rows = to.finish(run.values);
  run.statistics.bytes_spilled += to.spilled_bytes();
  if (run.results) run.statistics.bytes_spilled += run.results->spilled_bytes();
  run.results.reset();
  run.statistics.write_seconds += seconds_since(start);
}

}  // namespace pointsweep
