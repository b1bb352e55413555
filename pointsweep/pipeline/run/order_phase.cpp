// SPDX-License-Identifier: MIT
/// Puts the points of a pass, or the records of the output, in order along the axis.
#include <algorithm>

#include "pointsweep/pipeline/memory/forest_estimate.h"
#include "pointsweep/pipeline/rows/in_order_pass.h"
#include "pointsweep/pipeline/rows/nonfinite_points.h"
#include "pointsweep/pipeline/run/made_rows.h"
#include "pointsweep/pipeline/run/output_files.h"
#include "pointsweep/pipeline/run/phases.h"
#include "pointsweep/pipeline/run/survey_input.h"

namespace pointsweep {
namespace {

/// A request to put the points in order.
struct PointsInOrder {
  const PointSource& source;
  Survey& survey;  ///< of the source; its sample is needed no more when the stream is made
  const MemoryPlan& memory;
  bool canonical = false;  ///< ties, too
  bool whole = false;      ///< whole records travel, not only what the stages read
  std::vector<std::size_t> payload = {};
};

bool is_in_order(const RunState& run) { return run.checkpoints && run.checkpoints->last().is_in_order(); }

StreamOptions stream_options(const RunState& run, const PointsInOrder& how) {
  // The reorder of the output has no checkpoints, so its file may have the name of the first stream.
  const std::size_t number = *run.pass == run.plan.passes.size() ? 0 : *run.pass;
  return {.axis = how.survey.axis,
          .slab_points = how.memory.slab_points,
          .max_slab_points = 0,
          .canonical = how.canonical,
          .whole_records = how.whole,
          .payload = how.payload,
          .spill = run.place("stream", number, how.memory.spill_stream),
          .buffer_bytes = how.memory.stream_buffer_bytes,
          .progress = [&run](std::uint64_t rows) { run.report("ordering", rows, 0); }};
}

void note_nonfinite(RunState& run) {
  const std::uint64_t count = run.stream->nonfinite_count();
  if (run.statistics.nonfinite_rows.empty() && count > 0)
    run.statistics.nonfinite_rows = run.rows_of_cloud(first_nonfinite_rows(*run.stream, NonfiniteRows::kMostListed));
  run.statistics.nonfinite = std::max(run.statistics.nonfinite, run.statistics.dropped + count);
}

/// Slabs on demand. False where the points do not lie as the inputs say, or as the plan has estimated: then the plan is
/// that of a distribution pass.
bool make_on_demand(RunState& run, const PointsInOrder& how) {
  OnDemandOptions on_demand{.boxes = std::move(run.on_demand.boxes),
                            .block_rows = run.options.block_rows,
                            .read_ahead = run.statistics.threads,
                            .most_waiting = how.memory.most_waiting};
  std::string why_not;
  std::optional<Stream> stream =
      Stream::on_demand(how.source, how.survey, stream_options(run, how), on_demand, why_not);
  if (stream) {
    run.stream.emplace(std::move(*stream));
    return true;
  }
  run.memory.passes[*run.pass] = *run.memory.by_distribution;
  run.memory.order_text = "by distribution: " + why_not;
  run.results = results_of_pass(run, *run.pass);
  return false;
}

/// Returns whether the pass connects points.
bool needs_buckets(const RunState& run) {
  return *run.pass < run.plan.passes.size() && run.plan.passes[*run.pass].connecting_stage() != nullptr;
}

/// The stream of a checkpoint, or a new one.
void make_stream(RunState& run, const PointsInOrder& how) {
  const auto start = std::chrono::steady_clock::now();
  const bool on_demand = how.memory.on_demand && make_on_demand(run, how);
  const StreamOptions options = stream_options(run, how);
  if (is_in_order(run)) {
    run.checkpoints->require_slabs_of(how.memory.slab_points);
    Unpacker packed(run.checkpoints->last().stream);
    run.stream.emplace(packed, how.source, options);
    run.bucket_places = run.checkpoints->last().bucket_places;
  } else {
    if (!on_demand) run.stream.emplace(how.source, how.survey, options);
    run.bucket_places = needs_buckets(run) ? places_between_buckets(how.survey, run.source.count) : std::vector<Vec3>();
  }
  how.survey.sample = {};
  note_nonfinite(run);
  if (run.statistics.ordering.empty()) run.statistics.ordering = run.memory.order_text;
  run.statistics.order_seconds += seconds_since(start);
}

/// The records of the output, which go by positions that no sweep went by; or those of the input.
void order_output(RunState& run) {
  if (run.rows) {
    run.reordered.emplace(run.cloud, *run.rows, *run.layout, run.plan.by_moved_positions);
    run.source = run.reordered->positions();
    survey_source(run, true);
    if (!run.files) open_late(run);
    run.source = run.reordered->records();
  }
  make_stream(
      run,
      {.source = run.source, .survey = run.survey, .memory = run.memory.reordering, .canonical = true, .whole = true});
}

/// Puts the points in order by the places that an operator gives them. `run.survey` stays that of their positions.
void order_places(RunState& run, std::size_t p) {
  const PlannedPass& pass = run.plan.passes[p];
  const PlacedSource placed(run.source, pass.payload(), *pass.in_order());
  Survey of_places;
  const bool in_plane = pass.in_order()->in_order_contract().places == Places::in_plane;
  const std::optional<int> axis = in_plane && run.options.axis == 2 ? std::nullopt : run.options.axis;
  if (!is_in_order(run)) of_places = survey(placed.source, axis, false);
  make_stream(run, {.source = placed.source,
                    .survey = of_places,
                    .memory = run.memory.passes[p],
                    .canonical = true,
                    .payload = placed.payload});
}

}  // namespace

/// The reference reads points in canonical order, whatever order the output has: its search depends on it, and where it
/// is not exact, its results depend on the axis, too.
void order_phase(RunState& run, std::size_t p) {
  if (p == run.plan.passes.size()) return order_output(run);
  const PlannedPass& pass = run.plan.passes[p];
  if (pass.has_places()) return order_places(run, p);
  const bool whole = run.makes_output(p);
  const bool canonical = pass.kind == PassKind::order || whole || run.other_engine() != nullptr;
  if (p > 0 && !is_in_order(run)) survey_source(run, canonical);
  make_stream(run, {.source = run.source,
                    .survey = run.survey,
                    .memory = run.memory.passes[p],
                    .canonical = canonical,
                    .whole = whole,
                    .payload = pass.payload()});
}

}  // namespace pointsweep
