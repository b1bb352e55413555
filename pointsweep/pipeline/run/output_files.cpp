// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/run/output_files.h"

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "pointsweep/formats/known_values.h"
#include "pointsweep/formats/registry.h"
#include "pointsweep/pipeline/language/canonical_text.h"
#include "pointsweep/pipeline/output/output_formats.h"
#include "pointsweep/pipeline/output/provenance_record.h"
#include "pointsweep/pipeline/run/survey_input.h"

namespace pointsweep {
namespace {

/// Returns whether an attribute is not written because of Chain::keep.
bool leaves_out(const ChainPlan& plan) {
  std::set<std::string> made;
  for (const ChainStage& stage : plan.chain.stages)
    for (const Attribute& a : contract_of(stage).makes) made.insert(a.name);
  made.erase(selection_attribute().name);
  return plan.kept.input || !plan.kept.left_out.empty() || plan.kept.attributes.size() < made.size();
}

/// Returns whether every stage looks at its own point alone.
bool searches_nothing(const Chain& chain) {
  return !chain.stages.empty() && std::ranges::all_of(chain.stages, [](const ChainStage& stage) {
    return std::holds_alternative<Drop>(stage) || (operator_of(stage) != nullptr && contract_of(stage).default_k == 0);
  });
}

/// The stages of a record. A chain that searches no neighbours has no neighbourhood there.
std::vector<std::string> recorded_stages(const ChainPlan& plan) {
  std::vector<std::string> stages = canonical_stages(plan, Presets::left_out);
  if (searches_nothing(plan.chain)) stages.erase(stages.begin());
  return stages;
}

/// Returns the record of the run for its outputs.
RunRecord said_of(const RunState& run) {
  return {.stages = recorded_stages(run.plan),
          .keep = leaves_out(run.plan) ? run.plan.chain.keep : std::vector<std::string>{},
          .options = run.options,
          .axis = run.survey.axis,
          .drops_nonfinite = run.statistics.dropped > 0};
}

/// Returns the facts about all values that the format of an output needs before the first record; null if it needs
/// none.
std::shared_ptr<const KnownValues> values_if_needed(RunState& run, const Format* format) {
  if (format == nullptr || format->values == nullptr) return nullptr;
  const auto report = [&run](std::uint64_t rows) { run.report("ordering", rows, 0); };
  return std::make_shared<KnownValues>(format->values(run.cloud, report));
}

std::optional<Box> bounds_if_known(const RunState& run) {
  if (run.plan.graph.moved_bounds && !run.is_empty()) return run.moved_bounds();
  if (const Box& box = run.input.dropped().bounds; !box.empty() && !run.cloud.selection()) return box;
  if (run.is_empty()) return Box{Vec3{}, Vec3{}};
  return run.survey.exact && !run.survey.bounds.empty() ? std::optional(run.survey.bounds) : std::nullopt;
}

/// Returns the positions of the points of tiles after the last stage, from the rows that the last pass leaves; none if
/// no stage moves points.
std::optional<MovedPoints> moved_points(RunState& run) {
  const std::optional<Box> bounds = run.moved_bounds();
  if (!bounds) return std::nullopt;
  const std::vector<OutputFormat> written = output_formats(run.outputs);
  const auto on_grid = std::ranges::find_if(written, [](const OutputFormat& o) { return o.format->needs_bounds; });
  const auto values = values_if_needed(run, on_grid->format);
  const std::string position = position_attribute().name;
  std::size_t at = 0;
  for (const Attribute& a : run.plan.passes.back().carried) {
    if (a.name == position) break;
    at += a.bytes();
  }
  return MovedPoints{*bounds, values ? values->grid : std::nullopt, run.rows.get(), at};
}

TileRequest tiles_of(RunState& run) {
  const auto provenance = [&run](const InputCloud& input, std::size_t tile) {
    return provenance_of_tile(input, {tile, run.outputs.tiles.size()}, said_of(run));
  };
  return {run.cloud, run.names, run.outputs, run.options, provenance};
}

std::uint64_t record_bytes(const RunState& run) {
  return run.layout ? run.layout->schema().stride : run.cloud.schema().stride;
}

/// Returns the memory that the plan leaves free.
std::uint64_t spare_bytes(const RunState& run) {
  const std::uint64_t codecs = codec_bytes(run.cloud, run.outputs, record_bytes(run), run.statistics.threads);
  const std::uint64_t budget = run.statistics.memory_budget_bytes;
  return budget - std::min(budget, std::max(run.memory.expected_bytes, kFixedBytes + codecs));
}

/// Returns the memory that encoding one output may take.
std::uint64_t encoder_bytes(const RunState& run) {
  return encoder_bytes(run.outputs, record_bytes(run), run.statistics.threads) + spare_bytes(run);
}

/// Returns how many tiles can be completed beside the one that gets its rows.
std::size_t tiles_completing(const RunState& run) {
  constexpr std::uint64_t kChunksOfTile = 16 << 20;  // records on their way to its file
  const std::uint64_t of_tile = kChunksOfTile + encoder_bytes(run.outputs, record_bytes(run), run.statistics.threads);
  return std::min<std::uint64_t>(run.statistics.threads - 1, spare_bytes(run) / of_tile);
}

void open_files(RunState& run) {
  if (!run.outputs.tiles.empty()) {
    TileRequest request = tiles_of(run);
    request.moved = moved_points(run);
    request.completing = tiles_completing(run);
    return void(run.tiles.emplace(std::move(request), FinishedTiles(run.options.resume_folder)));
  }
  OutputPlace place{bounds_if_known(run), values_if_needed(run, format_of_output(run.outputs.points)),
                    encoder_bytes(run)};
  run.files.emplace(run.cloud, run.names.made, run.names.kept, run.outputs, run.options, std::move(place),
                    provenance_of(run.cloud, said_of(run)));
}

std::string text_of(const Box& box) {
  return fmt::format("x {:.9g} .. {:.9g}, y {:.9g} .. {:.9g}", box.lo.x, box.hi.x, box.lo.y, box.hi.y);
}

/// Polygons of another coordinate system are a frequent reason why no point is left.
std::string boxes_of_crop(const RunState& run) {
  Box cloud = run.survey.bounds;
  for (const auto& reader : run.cloud.readers())
    if (const std::optional<Box>& stated = reader->info().bounds) cloud.include(*stated);
  for (const GraphNode& node : run.plan.graph.nodes) {
    const auto* const select =
        node.op() == nullptr ? nullptr : std::get_if<std::shared_ptr<const SelectOperator>>(node.op());
    const std::optional<Box> extent = select == nullptr ? std::nullopt : (*select)->extent();
    if (!extent) continue;
    const std::string of_input = cloud.empty() ? "" : fmt::format(", the input {}", text_of(cloud));
    return fmt::format(": {} spans {}{}", (*select)->name(), text_of(*extent), of_input);
  }
  return "";
}

}  // namespace

void require_writable(RunState& run) {
  if (!run.outputs.tiles.empty())
    return require_writable_tiles(tiles_of(run), FinishedTiles(run.options.resume_folder), run.folders);
  Box somewhere = run.survey.bounds;
  if (somewhere.empty()) somewhere.include(Vec3{});
  OutputSet(run.cloud, run.names.made, run.names.kept, run.outputs, run.options, {somewhere, nullptr});
}

bool needs_bounds(const RunState& run) {
  const Format* const format = format_of_output(run.outputs.points);
  return format != nullptr && format->needs_bounds != nullptr && !run.plan.graph.moved_bounds &&
         (run.input.dropped().bounds.empty() || run.cloud.selection()) && format->needs_bounds(run.cloud.schema());
}

void open_outputs(RunState& run) {
  const bool late = run.plan.opens_late();
  if (late || !run.outputs.tiles.empty()) require_writable(run);
  if (!late) open_files(run);
}

void open_late(RunState& run) {
  if (needs_bounds(run) && !run.is_empty()) {
    run.source = run.cloud_source();
    const int axis = run.survey.axis;
    survey_source(run, true);
    run.survey.axis = axis;
  }
  run.statistics.points_written = run.cloud.count();
  if (run.is_empty() && run.outputs.tiles.empty())
    run.warn(fmt::format("no point passed; {} is empty{}.", name_of_output(run.outputs), boxes_of_crop(run)));
  open_files(run);
}

}  // namespace pointsweep
