// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/run/output_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/formats/crs.h"
#include "pointsweep/formats/known_values.h"
#include "pointsweep/formats/provenance.h"
#include "pointsweep/formats/registry.h"
#include "pointsweep/operators/kinds/box_reductions.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/pipeline/output/output_formats.h"
#include "pointsweep/program/declaration.h"
#include "pointsweep/program/run_options.h"
#include "pointsweep/row_error.h"
#include "pointsweep/storage/local/place.h"

namespace pointsweep {
namespace {

/// The facts that determine the result of a run, for its processing record.
struct RunRecord {
  std::vector<std::string> stages;  ///< result of recorded_stages()
  std::vector<std::string> keep;    ///< result of recorded_keep()
  const EngineOptions& options;
  int axis = 0;  ///< axis of the survey; recorded if the output is in order along it
  bool drops_nonfinite = false;
};

struct TileNumber {
  std::size_t tile = 0, tiles = 0;  ///< tiles are counted from 0
};

ProvenanceRecord record_of(const InputCloud& cloud, const RunRecord& run) {
  const EngineOptions& options = run.options;
  ProvenanceRecord record{.version = POINTSWEEP_VERSION, .stages = run.stages, .settings = {}, .inputs = {}};
  const auto set = [&](const char* name, const std::string& value) {
    if (!value.empty()) record.settings.emplace_back(name, value);
  };
  const bool in_order = run.stages == std::vector<std::string>{"sort"} || options.order == Order::sweep;
  set("keep", list_of_words(run.keep));
  for (const RunOption& option : run_options()) {
    if (option.effect != RunOption::Effect::values) continue;
    // The record states the axis that the run has chosen, and whether points were dropped, instead of the options.
    if (option.name == "axis")
      set("axis", in_order ? std::string(1, "xyz"[run.axis]) : "");
    else if (option.name == "nonfinite")
      set("nonfinite", run.drops_nonfinite ? "drop" : "");
    else if (option.name == "tile")
      set("tiles", option.text(options));  // the record's `tile` states the input of an output
    else
      set(option.name.c_str(), option.text(options));
  }
  if (const std::optional<StatedCrs>& stated = cloud.stated_crs())
    set("crs", stated->crs ? short_text(*stated->crs) : "none");
  const auto asked_for =
      std::ranges::find_if(cloud.readers(), [](const auto& r) { return !r->info().asked_for_as.empty(); });
  if (asked_for != cloud.readers().end()) set("format", (*asked_for)->info().asked_for_as);
  for (std::size_t i = 0; i < cloud.readers().size(); ++i) {
    if (!cloud.states()[i].is_known()) continue;
    const FileInfo& info = cloud.readers()[i]->info();
    const std::string name = options.input_paths ? whole_name(info.path) : file_name(info.path).string();
    record.inputs.push_back({name, info.count + info.left_out, info.bytes});
  }
  return record;
}

/// Returns the provenance for an output of this run: the records of the inputs, and with RunOptions::provenance the
/// record of the run. For a tile, the output for one input of a run, this record names that input and counts the
/// others.
std::vector<std::string> provenance_of(const InputCloud& cloud, const RunRecord& run,
                                       std::optional<TileNumber> number = {}) {
  std::vector<std::string> lines;
  for (const auto& reader : cloud.readers()) add_provenance(lines, reader->info().provenance);
  if (!run.options.provenance) return lines;
  ProvenanceRecord record = record_of(cloud, run);
  if (number) {
    record.settings.emplace_back("tile", fmt::format("{} of {}", number->tile + 1, number->tiles));
    record.more_inputs = number->tiles - 1;
  }
  // add_provenance() may leave out lines. The record of this run must be complete, even if an input has the same
  // record.
  const std::vector<std::string> own = lines_of(record);
  lines.insert(lines.end(), own.begin(), own.end());
  return lines;
}

/// Returns whether the order of columns in Chain::keep differs from the default: fields of the input, then made fields.
/// False if no output has a format that keeps the order of columns (LAS does not).
bool reorders(const Context& context) {
  const ChainPlan& plan = context.plan;
  const Schema& input = context.cloud.schema();
  const std::vector<OutputFormat> written = output_formats(context.outputs);
  if (std::ranges::none_of(written, [](const OutputFormat& o) { return o.format->real_coordinates; })) return false;
  std::vector<std::string> all;
  for (const Field& field : input.fields) all.push_back(field.name);
  for (const Attribute& a : plan.made) all.insert(all.end(), a.fields.begin(), a.fields.end());
  const auto place = [&](const std::string& name) { return std::ranges::find(all, name) - all.begin(); };
  return !std::ranges::is_sorted(plan.kept.order, {}, place);
}

/// Returns whether an attribute is not written because of Chain::keep or of a stage that drops attributes.
bool leaves_out(const ChainPlan& plan) {
  std::set<std::string> made;
  for (const ChainStage& stage : plan.chain.stages)
    for (const Attribute& a : contract_of(stage).makes) made.insert(a.name);
  made.erase(selection_attribute().name);
  return plan.kept.input || !plan.kept.left_out.empty() || plan.kept.attributes.size() < made.size();
}

/// Returns whether no stage looks at neighbours. False for a chain without stages, and for a chain with a Reneighbor or
/// Resort.
bool searches_nothing(const Chain& chain) {
  return !chain.stages.empty() && std::ranges::all_of(chain.stages, [](const ChainStage& stage) {
    return std::holds_alternative<Drop>(stage) || (operator_of(stage) != nullptr && contract_of(stage).default_k == 0);
  });
}

/// Returns the names of Chain::keep for a record: in the given order if the columns of an output have this order, else
/// sorted, each once. Returns none if the run keeps all attributes in the default order.
std::vector<std::string> recorded_keep(const Context& context) {
  std::vector<std::string> names = context.plan.chain.keep;
  if (reorders(context)) return names;
  if (!leaves_out(context.plan)) return {};
  std::ranges::sort(names);
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

RunRecord run_record_of(const Context& context, int axis) {
  return {.stages = context.part ? context.part->stages : recorded_stages(context.plan),
          .keep = recorded_keep(context),
          .options = context.options,
          .axis = axis,
          .drops_nonfinite = context.dropped.count > 0 || (context.part && context.part->drops_nonfinite)};
}

std::shared_ptr<const KnownValues> values_if_needed(const Context& context, const Format* format) {
  return values_if_needed(format, context.cloud, context.options.layout, context.progress_of("ordering"));
}

/// Returns the box of the moved points. Absent if no stage moves points, if the output does not need their box before
/// its first record, or if no row is left.
std::optional<Box> moved_bounds(const Context& context, const CloudValues& values) {
  const auto& value = context.plan.graph.moved_bounds;
  return value && !context.is_empty() ? std::optional(box_of(values.at(*value))) : std::nullopt;
}

std::optional<Box> bounds_if_known(const Context& context, const Survey& survey, const CloudValues& values) {
  if (const std::optional<Box> moved = moved_bounds(context, values)) return moved;
  if (const Box& box = context.dropped.bounds; !box.empty() && !context.cloud.selection()) return box;
  if (context.is_empty()) return Box{Vec3{}, Vec3{}};
  return survey.exact && !survey.bounds.empty() ? std::optional(survey.bounds) : std::nullopt;
}

/// Returns the positions of the points of tiles after the last stage, from the rows that the last pass leaves; none if
/// moved_bounds() is absent.
std::optional<MovedPoints> moved_points(const Context& context, const Rows& rows) {
  const std::optional<Box> bounds = moved_bounds(context, rows.values);
  if (!bounds) return std::nullopt;
  const std::vector<OutputFormat> written = output_formats(context.outputs);
  const auto on_grid = std::ranges::find_if(written, [](const OutputFormat& o) { return o.format->needs_bounds; });
  const auto values = values_if_needed(context, on_grid->format);
  const std::size_t at = offset_in(context.plan.passes.back().carried, position_attribute().name).value();
  return MovedPoints{*bounds, values ? values->grid : std::nullopt, rows.carried.get(), at};
}

/// Returns the request for tiles. All objects to which the context refers must outlive the request.
TileRequest tiles_of(const Context& context, int axis) {
  const auto provenance = [part = context.part, tiles = context.outputs.tiles.size(),
                           record = run_record_of(context, axis)](const InputCloud& input, std::size_t tile) {
    return provenance_of(input, record, part ? TileNumber{part->tile, part->tiles} : TileNumber{tile, tiles});
  };
  return {context.cloud, context.names, context.outputs, context.options, provenance};
}

/// Memory for the encoders of outputs.
struct EncoderMemory {
  EncoderMemory(const Context& context, const WorkPlan& work) : threads(work.memory.threads) {
    const std::uint64_t record = work.layout ? work.layout->schema().stride : context.cloud.schema().stride;
    const std::uint64_t codecs = context.codec_bytes(record, threads);
    one_output = encoder_bytes(context.outputs, record, threads);
    spare = work.budget - std::min(work.budget, std::max(work.memory.expected_bytes, kFixedBytes + codecs));
  }
  /// Returns the number of tiles that can be completed while another tile receives rows.
  std::size_t tiles_completing() const {
    constexpr std::uint64_t kChunksOfTile = 16 << 20;  // bytes of a tile's encoded chunks that wait to be written
    return std::min<std::uint64_t>(threads - 1, spare / (kChunksOfTile + one_output));
  }

  /// Returns the bytes for records that are divided among files; 0 if the output is not divided.
  std::uint64_t division(const EngineOptions& options) const {
    return options.division.divides() ? kLeastDivisionBytes + spare / 4 * 3 : 0;
  }
  /// Returns the bytes for encoding an output of all points.
  std::uint64_t encoding(const EngineOptions& options) const {
    return one_output + (options.division.divides() ? spare / 4 : spare);
  }

  unsigned threads;
  std::uint64_t one_output;  ///< bytes for encoding one output
  std::uint64_t spare;       ///< bytes of the budget that the plan does not use
};

OutputPlace place_of_output(const Context& context, const EncoderMemory& memory, const Survey& survey,
                            const CloudValues& values) {
  return {bounds_if_known(context, survey, values),
          values_if_needed(context, format_of_output(context.outputs.points)),
          memory.encoding(context.options),
          memory.division(context.options),
          context.places.scratch(),
          context.progress_of("completing")};
}

std::string text_of(const Box& box) {
  return fmt::format("x {:.9g} .. {:.9g}, y {:.9g} .. {:.9g}", box.lo.x, box.hi.x, box.lo.y, box.hi.y);
}

/// Describes the box of the first select that has one (such as polygons), and the box of the input. A common reason for
/// an empty result is that polygons have another coordinate system.
std::string boxes_of_crop(const Context& context, Box cloud) {
  for (const auto& reader : context.cloud.readers())
    if (const std::optional<Box>& stated = reader->info().bounds) cloud.include(*stated);
  for (const GraphNode& node : context.plan.graph.nodes) {
    const auto* const select = std::get_if<std::shared_ptr<const SelectOperator>>(node.op());
    const std::optional<Box> extent = select == nullptr ? std::nullopt : (*select)->extent();
    if (!extent) continue;
    const std::string of_input = cloud.empty() ? "" : fmt::format(", the input {}", text_of(cloud));
    return fmt::format(": {} spans {}{}", (*select)->name(), text_of(*extent), of_input);
  }
  return "";
}

}  // namespace

std::vector<std::string> recorded_stages(const ChainPlan& plan) {
  std::vector<std::string> stages = canonical_stages(plan, Presets::left_out);
  if (searches_nothing(plan.chain)) stages.erase(stages.begin());
  return stages;
}

CopyPlan plan_copy(const Context& context, const WorkPlan& work) {
  const EncoderMemory memory(context, work);
  return {
      plan_of_output(context.cloud, work.layout->schema(), context.names, context.outputs, context.options,
                     place_of_output(context, memory, {}, {}), provenance_of(context.cloud, run_record_of(context, 0))),
      memory.division(context.options)};
}

bool needs_bounds(const Context& context) {
  return !context.plan.graph.moved_bounds && (context.dropped.bounds.empty() || context.cloud.selection()) &&
         needs_bounds(format_of_output(context.outputs.points), context.cloud.schema(), context.options.layout);
}

void OutputFiles::require_writable(const Context& context, const Box& bounds) {
  const FinishedTiles finished(context.options.resume_folder);
  if (!context.outputs.tiles.empty()) return require_writable_tiles(tiles_of(context, 0), finished, folders_);
  make_folder(context);
  const Box somewhere = bounds.empty() ? Box{Vec3{}, Vec3{}} : bounds;
  OutputSet(context.cloud, context.names, context.outputs, context.options, {somewhere, nullptr});
}

void OutputFiles::make_folder(const Context& context) {
  if (context.options.division.divides()) folders_.make_for(context.outputs.points);
}

void OutputFiles::open(const Context& context, const WorkPlan& work, const Survey& survey, const Rows& rows) {
  const bool late = context.plan.opens_late();
  if (late || !context.outputs.tiles.empty()) require_writable(context, survey.bounds);
  if (!late) open_files(context, work, survey, rows);
}

void OutputFiles::open_late(const Context& context, const WorkPlan& work, Survey survey, const Rows& rows) {
  if (needs_bounds(context) && !context.is_empty()) {
    const int axis = survey.axis;
    survey = survey_points(context, context.cloud_source(), true);
    survey.axis = axis;
  }
  context.statistics().points_written = context.cloud.count();
  if (context.is_empty() && context.outputs.tiles.empty())
    context.report.warn(fmt::format("no point passed; {} is empty{}.", name_of_output(context.outputs),
                                    boxes_of_crop(context, survey.bounds)));
  open_files(context, work, survey, rows);
}

void OutputFiles::open_files(const Context& context, const WorkPlan& work, const Survey& survey, const Rows& rows) {
  make_folder(context);
  const EncoderMemory memory(context, work);
  if (!context.outputs.tiles.empty()) {
    TileRequest request = tiles_of(context, survey.axis);
    request.moved = moved_points(context, rows);
    request.completing = memory.tiles_completing();
    request.scratch = context.places.scratch();
    tiles_.emplace(request, FinishedTiles(context.options.resume_folder));
    return;
  }
  files_.emplace(context.cloud, context.names, context.outputs, context.options,
                 place_of_output(context, memory, survey, rows.values),
                 provenance_of(context.cloud, run_record_of(context, survey.axis)));
}

void OutputFiles::write_results(InputCloud& cloud, std::uint64_t first, std::span<const std::byte> results) {
  tiles_ ? tiles_->write_results(results) : files_->write_results(cloud, first, results);
}

void OutputFiles::finish(const Context& context) {
  const auto complete = [&] { tiles_ ? tiles_->finish() : files_->finish(context.cloud); };
  context.options.order == Order::sweep ? with_rows_of_output(complete) : complete();
  for (const std::string& warning : tiles_ ? tiles_->warnings() : files_->warnings()) context.report.warn(warning);
  context.statistics().bytes_written = tiles_ ? tiles_->bytes_written() : files_->bytes_written();
  context.statistics().files_written = tiles_ ? tiles_->files_written() : files_->files_written();
}

}  // namespace pointsweep
