// SPDX-License-Identifier: MIT
#include <algorithm>
#include <memory>
#include <set>
#include <thread>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/formats/files/same_file.h"
#include "pointsweep/free_memory.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/language/length_units.h"
#include "pointsweep/pipeline/output/kept_system.h"
#include "pointsweep/pipeline/output/output_formats.h"
#include "pointsweep/pipeline/run/made_rows.h"
#include "pointsweep/pipeline/run/phases.h"
#include "pointsweep/pipeline/run/run_checkpoints.h"
#include "pointsweep/row_error.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

OutputNames names_of_output(const RunState& run) {
  const bool is_sort = run.plan.passes.empty();
  if (is_sort || (run.outputs.points.empty() && run.outputs.tiles.empty() && !run.outputs.writer))
    return {run.plan.made, run.plan.kept, {}};
  return names_in_outputs(run.cloud, run.plan, run.outputs, run.options);
}

/// Warns of neighbourhoods that ask for more points than there are.
void note_neighborhoods(RunState& run) {
  std::set<std::size_t> noted;
  for (const PlannedPass& pass : run.plan.passes) {
    if (pass.kind != PassKind::sweep) continue;
    const std::size_t k = pass.plan.neighborhood.k;
    const bool limited = k != Neighborhood::kUnlimited;
    if (noted.empty()) run.statistics.k = limited ? k : 0;
    if (!noted.insert(k).second || !limited || k < run.cloud.count()) continue;
    run.warn(fmt::format("k = {} is more than the {} other points there are: neighbourhoods hold all of them.", k,
                         run.cloud.count() - 1));
  }
}

/// Other clouds that passes read are no outputs.
void open_other_clouds(RunState& run) {
  run.others = open_others(run.plan, run.cloud);
  for (const std::optional<OtherCloud>& other : run.others) {
    if (!other) continue;
    require_separate_files(other->files(), written_files(run.outputs, run.options));
    for (const std::string& warning : other->warnings()) run.warn(warning);
  }
}

/// Throws for a request that can be refused before the first point is read.
void check_request(RunState& run) {
  if (run.options.order == Order::sweep && !run.outputs.arrays.empty())
    fail_usage("Arrays have their rows in input order: leave out --order sweep.");
  require_outputs(run.outputs);
  require_lengths(run.cloud, run.plan.chain);
  for (const std::string& sentence : notes_on_defaults(run.cloud, run.plan.chain)) run.note(sentence);
  require_tiles_possible(run.outputs, run.options);
  run.names = names_of_output(run);
  run.warn(run.names.warning());
  run.warn(kept_system_warning(run.plan, run.cloud.crs(), run.outputs));
  if (const SweepEngine* engine = run.other_engine()) engine->require_can(run.plan, run.options);
  note_neighborhoods(run);
  open_other_clouds(run);
}

/// The cloud as the pass sees it, what its stages wait for, and a place for its results.
void begin_pass(RunState& run, std::size_t p) {
  run.pass = p;
  if (p == run.plan.passes.size()) return;
  PlannedPass& pass = run.plan.passes[p];
  const bool nothing_carried = p == 0 || run.plan.passes[p - 1].carried.empty();
  run.source = nothing_carried ? run.cloud_source() : updated_source(run.cloud_source(), *run.rows, pass);
  give_values(pass, run.values);
  if (pass.kind != PassKind::rows) run.results = results_of_pass(run, p);
}

void perform(RunState& run, const Phase& phase) {
  if (phase.kind != PhaseKind::survey && !run.is_empty() && run.pass != phase.pass) begin_pass(run, phase.pass);
  switch (phase.kind) {
    case PhaseKind::survey:
      open_run(run);
      return restore_rows(run);
    case PhaseKind::order:
      return order_phase(run, phase.pass);
    case PhaseKind::sweep:
      return sweep_phase(run, phase.pass);
    case PhaseKind::update:
      return update_phase(run, phase.pass);
    case PhaseKind::write:
      return write_phase(run, phase.pass);
  }
}

/// The outputs get their names.
void finish(RunState& run) {
  run.tiles ? run.tiles->finish() : run.files->finish(run.cloud);
  for (const std::string& warning : run.tiles ? run.tiles->warnings() : run.files->warnings()) run.warn(warning);
  if (run.checkpoints) run.checkpoints->finish();
  run.decoded.reset();
  // Rows are numbered as in the input, whose nonfinite points may have been dropped.
  for (DegenerateResults& results : run.statistics.degenerate_results)
    for (std::uint64_t& row : results.rows) row = run.cloud.input_row(row);
  run.statistics.bytes_written = run.tiles ? run.tiles->bytes_written() : run.files->bytes_written();
  run.statistics.total_seconds = seconds_since(run.started);
  run.statistics.peak_rss_bytes = peak_resident_bytes();
}

/// Returns the error with the row of the input: a pass numbers the rows that are left.
RowError in_input(RunState& run, const RowError& error) {
  const auto [input, row] = run.cloud.place_of_row(run.rows_of_cloud({error.row()}).front());
  if (run.cloud.readers().size() == 1) return error.numbered(row);
  return error.named(fmt::format("{} of {}", row, run.cloud.readers()[input]->info().path.string()));
}

/// An error while tiles are written also says how many are complete.
template <class Work>
void with_progress_of_tiles(RunState& run, Work work) {
  try {
    work();
  } catch (const UsageError&) {
    throw;
  } catch (const Cancelled&) {
    throw;
  } catch (const RowError& error) {
    throw Error(in_input(run, error).what() + (run.tiles ? run.tiles->progress() : ""));
  } catch (const Error& error) {
    throw Error(error.what() + (run.tiles ? run.tiles->progress() : ""));
  }
}

/// A run from the end of its survey to finished files.
Statistics run_after_survey(RunState& run) {
  for (const Phase& phase : phases_of(run.plan)) {
    const bool nothing_left = run.is_empty() && phase.kind != PhaseKind::write;
    if (nothing_left || is_done(run, phase)) continue;
    with_progress_of_tiles(run, [&] { perform(run, phase); });
    checkpoint_after(run, phase);
    return_free_memory();
  }
  with_progress_of_tiles(run, [&] { finish(run); });
  return std::move(run.statistics);
}

/// The survey tells how many threads work from then on, on which all else is made and ends.
Statistics run_phases(std::unique_ptr<RunState> surveyed) {
  check_request(*surveyed);
  open_checkpoints(*surveyed);
  with_progress_of_tiles(*surveyed, [&] { survey_phase(*surveyed); });
  Statistics statistics;
  with_threads(surveyed->memory.threads, [&] {
    const std::unique_ptr<RunState> run = std::move(surveyed);
    statistics = run_after_survey(*run);
  });
  return statistics;
}

/// Runs on as many threads as asked for, however many the caller's arena has.
Statistics run_plan(InputCloud& cloud, const Outputs& outputs, const EngineOptions& options, ChainPlan plan) {
  const unsigned threads =
      options.resources.threads != 0 ? options.resources.threads : std::max(1u, std::thread::hardware_concurrency());
  const CancellationScope scope(options.observer != nullptr ? &options.observer->token() : nullptr);
  Statistics statistics;
  with_threads(threads,
               [&] { statistics = run_phases(std::make_unique<RunState>(cloud, outputs, options, std::move(plan))); });
  return statistics;
}

/// Without passes: only the order of the output.
ChainPlan plan_sort(const Schema& input, const std::vector<std::string>& keep) {
  ChainPlan plan;
  plan.chain.keep = keep;
  if (!keep.empty()) plan.kept = kept_fields(keep, {}, input);
  plan.reorders = true;
  return plan;
}

}  // namespace

Statistics run(InputCloud& cloud, const Chain& chain, const Outputs& outputs, const EngineOptions& options) {
  return run_plan(cloud, outputs, options, plan_chain(chain, cloud.schema(), needs_of(outputs, options)));
}

Statistics sort(InputCloud& cloud, const std::filesystem::path& output, const EngineOptions& options,
                const std::vector<std::string>& keep) {
  return run_plan(cloud, {.points = output}, options, plan_sort(cloud.schema(), keep));
}

Statistics run(Cloud& cloud, const Chain& chain, const Outputs& outputs, const RunOptions& options) {
  return run(cloud.inputs(), chain, outputs, EngineOptions(options));
}

Statistics sort(Cloud& cloud, const std::filesystem::path& output, const RunOptions& options,
                const std::vector<std::string>& keep) {
  return sort(cloud.inputs(), output, EngineOptions(options), keep);
}

}  // namespace pointsweep
