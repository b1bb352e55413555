// SPDX-License-Identifier: MIT
/// Puts the points of a pass, or the records of the output, in order along the axis.
#include <algorithm>

#include "pointsweep/free_memory.h"
#include "pointsweep/pipeline/memory/sample_estimates.h"
#include "pointsweep/pipeline/rows/in_order_pass.h"
#include "pointsweep/pipeline/rows/nonfinite_points.h"
#include "pointsweep/pipeline/rows/ordered_output.h"
#include "pointsweep/pipeline/run/output_files.h"
#include "pointsweep/pipeline/run/phases.h"
#include "pointsweep/pipeline/sweep_engine.h"

namespace pointsweep {
namespace {

/// A request to put points in order.
struct PointsInOrder {
  const PointSource& source;
  Surveyed points;  ///< survey of the source
  std::size_t pass;
  const MemoryPlan& memory;
  bool canonical = false;  ///< StreamOptions::canonical: slabs in canonical order, or as a sweep should read them
  bool whole = false;      ///< true to stream whole records instead of the attributes that stages read
  bool numbered = false;   ///< true if the records of `source` end with their row (StreamOptions::numbered)
  std::vector<std::size_t> payload = {};
};

bool is_resumed_in_order(const Context& context) {
  Checkpoints* const checkpoints = context.places.checkpoints();
  return checkpoints != nullptr && checkpoints->last().is_in_order();
}

StreamOptions stream_options(const Context& context, const PointsInOrder& how, const MemoryPlan& memory) {
  // The reorder of the output after the passes saves no checkpoint, so its file may have the name of the first stream.
  // Without passes (a sort) it is the first stream.
  const std::size_t number = how.pass == context.plan.passes.size() ? 0 : how.pass;
  return {.axis = how.points.survey.axis,
          .slab_points = memory.slab_points,
          .max_slab_points = 0,
          .canonical = how.canonical,
          .whole_records = how.whole,
          .numbered = how.numbered,
          .payload = how.payload,
          .spill = context.places.place("stream", number, memory.spill_stream),
          .buffer_bytes = memory.stream_buffer_bytes,
          .progress = context.progress_of("ordering")};
}

void note_nonfinite(const Context& context, const Stream& stream) {
  const std::uint64_t count = stream.nonfinite_count();
  Statistics& statistics = context.statistics();
  if (statistics.nonfinite_rows.empty() && count > 0)
    statistics.nonfinite_rows = context.rows_of_cloud(first_nonfinite_rows(stream, NonfiniteRows::kMostListed));
  statistics.nonfinite = std::max(statistics.nonfinite, context.dropped.count + count);
}

/// Returns a stream that makes slabs on demand (docs/adr/0011). Absent if the memory plan has no such stream, or if the
/// points do not lie where the inputs state or the plan expects. In the second case `why_not` gets the reason.
std::optional<Stream> stream_on_demand(const Context& context, const WorkPlan& work, PointsInOrder& how,
                                       std::string& why_not) {
  if (!how.memory.on_demand) return std::nullopt;
  OnDemandOptions on_demand{.boxes = std::move(how.points.boxes),
                            .block_rows = context.options.block_rows,
                            .read_ahead = work.memory.threads,
                            .most_waiting = how.memory.most_waiting};
  return Stream::on_demand(how.source, how.points.survey, stream_options(context, how, how.memory), on_demand, why_not);
}

/// Returns whether the pass connects points.
bool needs_buckets(const ChainPlan& plan, std::size_t p) {
  return p < plan.passes.size() && plan.passes[p].connecting_stage() != nullptr;
}

/// Opens the stream of a checkpoint.
Ordered restored(const Context& context, PointsInOrder how, const MemoryPlan& memory) {
  const Checkpoints& checkpoints = *context.places.checkpoints();
  checkpoints.require_slabs_of(memory.slab_points);
  Decoder in(checkpoints.last().stream);
  Stream stream(in, how.source, stream_options(context, how, memory));
  in.finish();
  return {std::move(stream), checkpoints.last().bucket_places, std::move(how.points.survey), memory};
}

/// Makes a new stream. If slabs on demand were planned and are not possible, the plan for a distribution pass is used.
Ordered distributed(const Context& context, const WorkPlan& work, PointsInOrder how) {
  std::string why_not;
  std::optional<Stream> stream = stream_on_demand(context, work, how, why_not);
  const MemoryPlan& memory = how.memory.on_demand && !stream ? *work.memory.by_distribution : how.memory;
  if (!stream) stream.emplace(how.source, how.points.survey, stream_options(context, how, memory));
  std::vector<Vec3> buckets;
  if (needs_buckets(context.plan, how.pass)) buckets = places_between_buckets(how.points.survey, how.source.count);
  if (!why_not.empty() && context.statistics().ordering.empty())
    context.statistics().ordering = "by distribution: " + why_not;
  return {std::move(*stream), std::move(buckets), std::move(how.points.survey), memory};
}

Ordered put_in_order(const Context& context, const WorkPlan& work, PointsInOrder how) {
  const auto start = std::chrono::steady_clock::now();
  const MemoryPlan& memory = how.memory;
  const bool numbered = how.numbered;
  Ordered made = is_resumed_in_order(context) ? restored(context, std::move(how), memory)
                                              : distributed(context, work, std::move(how));
  free_memory_of(made.survey.sample);
  if (!numbered) note_nonfinite(context, made.stream);
  if (context.statistics().ordering.empty()) context.statistics().ordering = work.memory.order_text;
  context.statistics().order_seconds += seconds_since(start);
  return made;
}

/// Puts the records of the output in order (ChainPlan::reorders); in a sort, the records of the input.
Ordered order_output(const Context& context, const WorkPlan& work, const Rows& rows, Surveyed points,
                     OutputFiles& files) {
  const auto whole = [&](const PointSource& source) {
    return put_in_order(context, work,
                        {.source = source,
                         .points = std::move(points),
                         .pass = context.plan.passes.size(),
                         .memory = work.memory.reordering,
                         .canonical = true,
                         .whole = true});
  };
  if (!rows.carried) return whole(context.cloud_source());
  const Reordering reordering(context.cloud, *rows.carried, *work.layout, context.plan.by_moved_positions);
  points.survey = survey_points(context, reordering.positions(), true);
  if (!files.are_open()) files.open_late(context, work, points.survey, rows);
  return whole(reordering.records());
}

/// Puts the points in order by the places that an operator assigns to them. Keeps the survey of their positions.
Ordered order_places(const Context& context, const WorkPlan& work, std::size_t p, const PointSource& source,
                     const std::vector<std::size_t>& payload, bool numbered, Survey of_positions) {
  const PlannedPass& pass = context.plan.passes[p];
  const PlacedSource placed(source, payload, *pass.in_order());
  Surveyed of_places;
  const bool in_plane = pass.in_order()->in_order_contract().places == Places::in_plane;
  const std::optional<int> axis = in_plane && context.options.axis == 2 ? std::nullopt : context.options.axis;
  if (!is_resumed_in_order(context)) of_places.survey = survey(placed.source, axis, false);
  Ordered made = put_in_order(context, work,
                              {.source = placed.source,
                               .points = std::move(of_places),
                               .pass = p,
                               .memory = work.memory.passes[p],
                               .canonical = true,
                               .numbered = numbered,
                               .payload = placed.payload});
  made.survey = std::move(of_positions);
  free_memory_of(made.survey.sample);
  return made;
}

}  // namespace

/// Puts the points of a pass in order. The reference engine always gets canonical order, along the axis of the options
/// or else the axis that a survey of all points has chosen, because its search can be approximate; then the results
/// depend on order and axis.
Ordered order_pass(const Context& context, const WorkPlan& work, std::size_t p, const Rows& rows, Surveyed points,
                   OutputFiles& files) {
  if (p == context.plan.passes.size()) return order_output(context, work, rows, std::move(points), files);
  const PlannedPass& pass = context.plan.passes[p];
  const PointSource source = source_of_pass(context, p, rows);
  // In a task over one tile, this function puts points in the order of a sweep. For an in-order pass, order_numbered()
  // later puts them in the order that the operator needs.
  const bool is_in_order = pass.kind == PassKind::order && !context.part;
  if (pass.has_places() && is_in_order)
    return order_places(context, work, p, source, pass.payload(), false, std::move(points.survey));
  const bool whole = context.makes_output(p);
  const bool canonical = is_in_order || whole || engine_of(context.options.engine) != nullptr;
  if (p > 0 && !is_resumed_in_order(context)) {
    points.survey = survey_points(context, source, canonical);
    if (pass.kind != PassKind::order) require_distances(points.survey.bounds);
  }
  return put_in_order(context, work,
                      {.source = source,
                       .points = std::move(points),
                       .pass = p,
                       .memory = work.memory.passes[p],
                       .canonical = canonical,
                       .whole = whole,
                       .payload = pass.payload()});
}

Ordered order_numbered(const Context& context, const WorkPlan& work, std::size_t p, const PointSource& numbered,
                       Survey of_part, std::uint64_t first_row) {
  const PlannedPass& pass = context.plan.passes[p];
  std::vector<std::size_t> payload;
  for (std::size_t f = kAxisNames.size(); f < numbered.schema.fields.size(); ++f) payload.push_back(f);
  Ordered made = pass.has_places() ? order_places(context, work, p, numbered, payload, true, std::move(of_part))
                                   : put_in_order(context, work,
                                                  {.source = numbered,
                                                   .points = {survey(numbered, of_part.axis, false), {}},
                                                   .pass = p,
                                                   .memory = work.memory.passes[p],
                                                   .canonical = true,
                                                   .numbered = true});
  made.first_row = first_row;
  return made;
}

}  // namespace pointsweep
