// SPDX-License-Identifier: MIT
#include "pointsweep/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/free_memory.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/memory/run_memory.h"
#include "pointsweep/pipeline/memory/sample_estimates.h"
#include "pointsweep/pipeline/output/output_formats.h"
#include "pointsweep/pipeline/rows/input_source.h"
#include "pointsweep/pipeline/rows/nonfinite_points.h"
#include "pointsweep/pipeline/rows/pass_update.h"
#include "pointsweep/pipeline/run/output_files.h"
#include "pointsweep/pipeline/run/phases.h"
#include "pointsweep/pipeline/run/request.h"
#include "pointsweep/pipeline/statistics.h"
#include "pointsweep/row_error.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

/// Continues the counts of an earlier process whose checkpoints this run resumes, if any.
void take_over(RunPlaces& places, const EngineOptions& options, const RunReport& report) {
  const Checkpoints* const checkpoints = places.checkpoints();
  if (checkpoints == nullptr || !checkpoints->found()) return;
  take_counts(report.statistics, checkpoints->last().counts);
  if (options.resources.memory_bytes == 0) report.statistics.memory_budget_bytes = checkpoints->last().memory_bytes;
  report.note("Went on where an earlier process had ended: times and series are of this one alone.");
}

/// Returns the rows and values that an earlier process has stored for the next pass. `all`: all rows of the run.
Rows restored_rows(const Context& context, std::shared_ptr<InputCloud> all) {
  Rows rows{.cloud = std::move(all)};
  Checkpoints* const checkpoints = context.places.checkpoints();
  if (checkpoints == nullptr || checkpoints->last().sweep == 0) return rows;
  const Checkpoint& last = checkpoints->last();
  if (last.mask > 0)
    rows.cloud = std::make_shared<InputCloud>(
        context.cloud.selected(RowMask::kept(context.cloud.count(), checkpoints->place("mask", last.mask))));
  for (std::size_t v = 0; v < last.values.size(); ++v)
    if (!last.values[v].empty()) rows.values[v] = last.values[v];
  const std::size_t bytes = context.plan.passes[last.sweep - 1].carried_bytes();
  rows.carried =
      std::make_unique<RowFile>(RowFile::kept(rows.cloud->count(), bytes, checkpoints->place("rows", last.sweep)));
  return rows;
}

/// Returns whether a phase is left out because an earlier process has completed it. The survey, and an order phase
/// whose sweep is not complete, are performed again, from the values of the checkpoint.
bool is_done(const Checkpoints* checkpoints, const Phase& phase) {
  if (checkpoints == nullptr || phase.kind == PhaseKind::survey) return false;
  const Checkpoint& last = checkpoints->last();
  if (phase.pass != last.sweep) return phase.pass < last.sweep;
  const bool before_results = phase.kind == PhaseKind::order || phase.kind == PhaseKind::sweep;
  return before_results && last.is_swept();
}

/// Notes which pass takes longest if the expected time is long.
void give_notice(const RunMemory& memory, Observer* observer) {
  double seconds = 0;
  for (const Effort& effort : memory.efforts) seconds += effort.seconds;
  if (seconds < kLongSeconds || observer == nullptr) return;
  const Effort& most = *std::ranges::max_element(memory.efforts, {}, &Effort::seconds);
  observer->on_note(fmt::format("{} means {}, {}; {}.", most.cause, most.text, about_time_text(seconds), most.remedy));
}

/// Performs `work`. Adds the number of complete tiles to its errors, and converts their row numbers from selected rows
/// to rows of the input.
template <class Work>
void with_progress_of_tiles(const Context& context, OutputFiles& files, Work work) {
  const auto work_on_rows = [&] {
    try {
      work();
    } catch (const RowError& error) {
      throw Error(context.located(error).what());
    }
  };
  extending_errors(work_on_rows, [&] { return files.progress(); });
}

/// Performs the phases after the survey, and owns the values passed between phases.
class Phases {
 public:
  /// `checkpoints`: null for a run that cannot be resumed.
  Phases(const InputCloud& cloud, const WorkPlan& work, OtherClouds& others, OutputFiles& files, Surveyed points,
         Checkpoints* checkpoints)
      : work_(work), others_(others), files_(files), checkpoints_(checkpoints), points_(std::move(points)) {
    rows_.cloud = std::make_shared<InputCloud>(cloud);
  }

  /// Returns the rows that no phase so far has dropped.
  const std::shared_ptr<InputCloud>& cloud() const { return rows_.cloud; }

  /// `context`: the context over cloud().
  void perform(const Phase& phase, const Context& context) {
    switch (phase.kind) {
      case PhaseKind::survey:
        return open(context);
      case PhaseKind::order:
        return order(phase.pass, context);
      case PhaseKind::sweep:
        return sweep(phase.pass, context);
      case PhaseKind::update:
        return update(phase.pass, context);
      case PhaseKind::write:
        return write(phase.pass, context);
    }
  }

 private:
  void open(const Context& context) {
    files_.open(context, work_, points_.survey, rows_);
    give_notice(work_.memory, context.report.observer);
    rows_ = restored_rows(context, rows_.cloud);
    if (checkpoints_ == nullptr) return;
    checkpoints_->surveyed(points_.survey, work_.budget);
    if (const auto& ordered = checkpoints_->last().ordered) points_ = {.survey = *ordered, .boxes = {}};
  }

  void order(std::size_t p, const Context& context) {
    ordered_ = std::make_unique<Ordered>(order_pass(context, work_, p, rows_, std::move(points_), files_));
    points_ = {.survey = ordered_->survey, .boxes = {}};
    const bool of_rows = p == context.plan.passes.size() && p > 0;  // the reorder after the passes saves no checkpoint
    if (checkpoints_ != nullptr && !of_rows)
      checkpoints_->in_order(ordered_->stream, ordered_->memory.slab_points, ordered_->survey, ordered_->bucket_places);
  }

  void sweep(std::size_t p, const Context& context) {
    const auto other = [&](int axis, const auto& take) {
      others_[p]->give_in_order(axis, &context.places.folder(), context.progress_of("ordering"), take);
    };
    results_ = sweep_pass(context, work_, p, std::move(ordered_), rows_.values, {.other = other});
    if (checkpoints_ != nullptr) checkpoints_->swept(*results_, context.statistics());
  }

  void update(std::size_t p, const Context& context) {
    rows_ = update_pass(context, work_, p, std::move(rows_), results(p, context));
    if (checkpoints_ != nullptr)
      checkpoints_->updated(context.plan.passes[p].selects, rows_.values, context.statistics());
  }

  void write(std::size_t p, const Context& context) {
    if (!files_.are_open()) files_.open_late(context, work_, points_.survey, rows_);
    const std::unique_ptr<RowStore> made = results(p, context);
    write_output(context, work_, p, rows_, ordered_.get(), made.get(), files_);
  }

  /// Returns the results of the sweep of pass `p`, which an earlier process may have made; null if there was no sweep,
  /// as for a pass over rows.
  std::unique_ptr<RowStore> results(std::size_t p, const Context& context) {
    const bool sweeps = p < context.plan.passes.size() && context.plan.passes[p].kind != PassKind::rows;
    if (results_ == nullptr && sweeps && !context.is_empty())
      return results_of_pass(context, work_, work_.memory.passes[p], p);
    return std::move(results_);
  }

  const WorkPlan& work_;
  OtherClouds& others_;
  OutputFiles& files_;
  Checkpoints* const checkpoints_;
  Surveyed points_;                    ///< survey for the next order phase, and its boxes
  Rows rows_;                          ///< rows after the last update
  std::unique_ptr<Ordered> ordered_;   ///< made by an order phase, used by the next sweep or write
  std::unique_ptr<RowStore> results_;  ///< made by a sweep, used by the next update or write
};

/// Performs a run after its survey, until the outputs are complete.
void perform_phases(const Context& whole, const WorkPlan& work, Surveyed points, OtherClouds& others,
                    OutputFiles& files) {
  Checkpoints* const checkpoints = whole.places.checkpoints();
  Phases phases(whole.cloud, work, others, files, std::move(points), checkpoints);
  const auto with_rows_left = [&](const auto& step) {
    const std::shared_ptr<InputCloud> left = phases.cloud();  // keeps the rows alive while a phase replaces them
    const Context context = whole.over(*left);
    with_progress_of_tiles(context, files, [&] { step(context); });
  };
  for (const Phase& phase : phases_of(whole.plan)) {
    const bool nothing_left = phases.cloud()->count() == 0 && phase.kind != PhaseKind::write;
    if (nothing_left || is_done(checkpoints, phase)) continue;
    with_rows_left([&](const Context& context) { phases.perform(phase, context); });
    return_free_memory_above(work.spare_bytes());
  }
  with_rows_left([&](const Context& context) {
    files.finish(context);
    if (checkpoints != nullptr) checkpoints->finish();
  });
}

/// Performs a run. The memory plan after the survey decides the number of threads; all later work runs in an arena of
/// that size.
void perform(const Context& encoded, OtherClouds& others) {
  auto files = std::make_unique<OutputFiles>();
  std::optional<InputCloud> cloud;
  with_progress_of_tiles(encoded, *files, [&] { cloud.emplace(decode_input(encoded, *files)); });
  const Context context = encoded.over(*cloud);
  Surveyed points;
  std::optional<const WorkPlan> work;
  with_progress_of_tiles(context, *files, [&] {
    points.survey = survey_input(context);
    work.emplace(plan_work(context, points));
  });
  with_threads(work->memory.threads, [&] {
    const std::unique_ptr<OutputFiles> open = std::move(files);
    perform_phases(context, *work, std::move(points), others, *open);
  });
}

Statistics run_request(const Request& given) {
  const auto start = std::chrono::steady_clock::now();
  require_own_files(given);
  // Tiles get the attributes of their own input, not those of the cloud.
  const bool uses_attributes = given.outputs.tiles.empty() || reads_attributes(given.plan);
  FiniteInput input =
      finite_input(uses_attributes ? given.cloud : given.cloud.with_unused_attributes(), given.outputs, given.options);
  const Request request{input.cloud, given.outputs, given.options, given.plan};
  Statistics statistics = first_counts(request, input.dropped);
  const RunReport report{statistics, request.options.observer};
  require_work(request);
  if (report.observer != nullptr)
    for (const std::string& sentence : statistics.warnings) report.observer->on_warning(sentence);
  report.warn(input.warning());
  const OutputNames names = check_request(request, report);
  OtherClouds others = open_other_clouds(request, report);
  RunPlaces places(request.options, identity_of(request, others));
  take_over(places, request.options, report);
  perform({request.cloud, request.outputs, request.options, request.plan, names, input.dropped, places, report,
           open_input_bytes(request.cloud), copies_rows(request)},
          others);
  // Reported rows are numbered in the input, from which nonfinite points may have been dropped.
  for (DegenerateResults& results : statistics.degenerate_results)
    for (std::uint64_t& row : results.rows) row = request.cloud.input_row(row);
  statistics.total_seconds = seconds_since(start);
  statistics.peak_rss_bytes = peak_resident_bytes();
  return statistics;
}

/// Performs the run in an arena of its own, so that the caller's number of threads has no effect.
Statistics run_plan(const InputCloud& cloud, const Outputs& outputs, const EngineOptions& options,
                    const ChainPlan& plan) {
  const CancellationScope scope(options.observer != nullptr ? &options.observer->token() : nullptr);
  InputCloud input = input_of_chain(cloud, plan);
  Statistics statistics;
  with_threads(survey_threads(input, options), [&] { statistics = run_request({input, outputs, options, plan}); });
  return statistics;
}

}  // namespace

std::vector<Phase> phases_of(const ChainPlan& plan) {
  std::vector<Phase> phases = {{PhaseKind::survey}};
  const std::size_t passes = plan.passes.size();
  for (std::size_t p = plan.only_copies() ? passes : 0; p < passes; ++p) {
    if (plan.passes[p].kind != PassKind::rows) {
      phases.push_back({PhaseKind::order, p});
      phases.push_back({PhaseKind::sweep, p});
    }
    phases.push_back({plan.leaves_rows(p) ? PhaseKind::update : PhaseKind::write, p});
  }
  if (plan.reorders) phases.push_back({PhaseKind::order, passes});
  if (phases.back().kind != PhaseKind::write) phases.push_back({PhaseKind::write, passes});
  return phases;
}

Statistics run(InputCloud& cloud, const Chain& chain, const Outputs& outputs, const EngineOptions& options) {
  return run_plan(cloud, outputs, options, plan_chain(chain, cloud.schema(), needs_of(outputs, options)));
}

Statistics sort(InputCloud& cloud, const std::filesystem::path& output, const EngineOptions& options,
                const std::vector<std::string>& keep) {
  require_order_kept({.points = output});
  return run_plan(cloud, {.points = output}, options, plan_sort(cloud.schema(), keep));
}

Statistics run(Cloud& cloud, const Chain& chain, const Outputs& outputs, const RunOptions& options) {
  return run(cloud.inputs(), chain, outputs, EngineOptions(options));
}

Statistics sort(Cloud& cloud, const std::filesystem::path& output, const RunOptions& options,
                const std::vector<std::string>& keep) {
  return sort(cloud.inputs(), output, EngineOptions(options), keep);
}

Observer::~Observer() = default;
void Observer::on_progress(const Progress&) {}
void Observer::on_warning(const std::string&) {}
void Observer::on_note(const std::string& sentence) { on_warning(sentence); }
const CancellationToken& Observer::token() const noexcept { return own_; }

}  // namespace pointsweep
