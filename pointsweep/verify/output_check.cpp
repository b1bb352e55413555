// SPDX-License-Identifier: MIT
/// The check of an output file, or of the files of a folder, against the run that the processing record of the output
/// describes.
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/files.h"
#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/formats/files/file_pattern.h"
#include "pointsweep/formats/files/folders.h"
#include "pointsweep/formats/registry.h"
#include "pointsweep/operators/statistics/neighbor_rows.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/pipeline/rows/nonfinite_points.h"
#include "pointsweep/points/input_row.h"
#include "pointsweep/program/pipeline.h"
#include "pointsweep/program/run_options.h"
#include "pointsweep/reader.h"
#include "pointsweep/storage/local/place.h"
#include "pointsweep/storage/remote/url.h"
#include "pointsweep/verify/chain_values.h"
#include "pointsweep/verify/verify.h"

namespace pointsweep {
namespace {

namespace fs = std::filesystem;

/// The files and options of a check, completed by the record of the output.
struct OutputCheck {
  std::vector<fs::path> inputs;
  fs::path output;
  VerifyOptions options;
  std::vector<OptionText> neighborhood;
  std::vector<fs::path> tiles;  ///< files of an output folder: one for each input, or the parts of a divided output
  bool recorded = false;        ///< true if the pipeline comes from the record, where default lengths are not converted
  bool without_stages = false;  ///< true if the run was a sort or a conversion, according to its record

  /// Returns the file whose format and record stand for the whole output.
  const fs::path& first_file() const { return tiles.empty() ? output : tiles.front(); }
  bool is_divided() const { return options.division.divides(); }
  bool says_how() const { return !options.pipeline.empty() || !neighborhood.empty() || !options.keep.empty(); }
};

/// Returns whether the order of the output's points is unknown: neither that of the input nor stated by an option or a
/// record, as in a divided output and in a format that reorders points.
bool is_in_any_order(const OutputCheck& check) {
  const Format* const format = format_of_output(check.first_file());
  return check.is_divided() || (format != nullptr && format->reorders);
}

/// Returns whether this program has all operators of the pipeline. A program that uses the library may have others.
bool is_known(const std::string& pipeline) {
  try {
    build_chain(parse_pipeline(pipeline), Facts{});
    return true;
  } catch (const UsageError&) {
    return false;
  }
}

/// Takes the pipeline and the kept attributes from the record. If the pipeline has unknown operators, the user must
/// name the inputs, and the attributes found in the output decide what is checked.
void take_recorded_pipeline(OutputCheck& check, const ProvenanceRecord& record) {
  const std::string pipeline = fmt::format("{}", fmt::join(record.stages, " | "));
  check.without_stages = pipeline == "sort" || pipeline == "convert";
  if (check.without_stages || is_known(pipeline)) {
    if (!check.without_stages) check.options.pipeline = pipeline;
    check.recorded = true;
    if (record.setting("keep")) check.options.keep = words_of(*record.setting("keep"));
  } else if (check.inputs.empty()) {
    fail_usage("{}: was made by '{}', of which not all operators are known here; name the inputs as well.",
               check.output.string(), pipeline);
  }
}

/// Returns whether the record states the order of other rows than those of the inputs that the user has named: the
/// record names other inputs, or it describes a divided output while the output is a single file, made from the parts
/// later. False if the user has named no inputs.
bool is_of_other_rows(const OutputCheck& check, const ProvenanceRecord& record) {
  if (check.inputs.empty()) return false;
  if (check.tiles.empty() && recorded_division(record).divides()) return true;
  if (check.inputs.size() != record.inputs.size() + record.more_inputs) return true;
  return !std::ranges::equal(
      std::span(check.inputs).first(record.inputs.size()), record.inputs, {},
      [](const fs::path& path) { return path.filename(); },
      [](const ProvenanceInput& input) { return fs::path(input.name).filename(); });
}

/// Completes the options from the record of the output.
void take_record(OutputCheck& check, const ProvenanceRecord& record) {
  VerifyOptions& options = check.options;
  const auto setting = [&](const char* name) { return record.setting(name).value_or(""); };
  if (options.prefix.empty()) options.prefix = setting("prefix");
  if (const std::string crs = setting("crs"); !options.cloud.crs && (crs == "none" || crs.starts_with("EPSG:")))
    options.cloud.crs = StatedCrs{parse_crs(crs.substr(0, crs.find(' '))), true};
  RunOptions recorded;
  for (const char* name : {"decimals", "positions"})
    if (const auto value = record.setting(name)) run_option(name).set(recorded, *value, "the record of the output");
  if (!options.decimals) options.decimals = recorded.layout.decimals;
  if (!options.positions) options.positions = recorded.positions;
  if (options.cloud.format.empty()) options.cloud.format = setting("format");
  if (options.nonfinite == Nonfinite::by_format && setting("nonfinite") == "drop") options.nonfinite = Nonfinite::drop;
  if (check.says_how()) return;
  take_recorded_pipeline(check, record);
  const bool sorted = record.stages == std::vector<std::string>{"sort"};
  const bool is_swept = setting("order") == "sweep" || sorted;
  if (!options.order && (is_swept || !is_of_other_rows(check, record)))
    options.order = is_swept ? Order::sweep : Order::input;
  const std::string axis = setting("axis");
  if (!options.axis && axis.size() == 1 && axis >= "x" && axis <= "z") options.axis = axis[0] - 'x';
}

/// Returns the path of the output for an input in a folder of outputs. The output may have another format than the
/// input.
fs::path tile_of(const ListedFile& input, const fs::path& folder) {
  fs::path tile = folder / tile_name(input.relative, "");
  if (exists_at(tile)) return tile;
  for (const std::string_view extension : writable_extensions())
    if (const auto other = folder / tile_name(input.relative, std::string(extension)); exists_at(other)) return other;
  fail("{}: is missing, the output for {}; was it moved, or is the run not complete?", tile.string(),
       input.path.string());
}

/// If a run has divided its output among the files of the folder or pattern, according to the options or to the record
/// of the first file, stores these files as tiles of the check.
void list_parts(OutputCheck& check) {
  const auto is_file = [](const fs::directory_entry& entry) {
    return !is_hidden(entry.path()) && entry.is_regular_file() && is_point_file(entry.path());
  };
  if (is_folder(check.output) && !is_url(check.output) && std::ranges::none_of(entries_of(check.output), is_file))
    return;
  const InputList files = list_inputs({check.output}, false, "");
  OutputDivision& division = check.options.division;
  const std::optional<ProvenanceRecord> record = recorded_run(files.files.front().path);
  if (record && !division.divides()) division = recorded_division(*record);
  if (!division.divides()) return;
  for (const ListedFile& file : files.files) check.tiles.push_back(file.path);
}

/// Replaces folders, patterns and .vpc files among the inputs by the files for which they stand. If the output is a
/// folder, also lists its files.
void list_files(OutputCheck& check) {
  const fs::path& output = check.output;
  const bool is_folder = pointsweep::is_folder(output);
  const bool is_pattern = !is_url(output) && is_file_pattern(output);
  if (is_folder || is_pattern) list_parts(check);
  if (is_pattern && !check.is_divided())
    fail_usage("{}: its files are no tiles and no parts of one output; name one of them, or their folder.",
               output.string());
  if (check.inputs.empty() && is_folder && !check.is_divided())
    fail_usage("{}: is a folder; name the inputs too: pointsweep verify tiles/ {}.", output.string(), output.string());
  if (check.inputs.empty()) return;
  const InputList inputs = list_inputs(check.inputs, check.options.recursive, check.options.cloud.format);
  check.inputs.clear();
  for (const ListedFile& input : inputs.files) {
    check.inputs.push_back(input.path);
    if (is_folder && !check.is_divided()) check.tiles.push_back(tile_of(input, output));
  }
}

/// Completes the check with its inputs and the record of the output.
OutputCheck completed(OutputCheck check) {
  list_files(check);
  const fs::path& output = check.output;
  const std::optional<ProvenanceRecord> record = recorded_run(check.first_file());
  if (record) take_record(check, *record);
  if (record && record->setting("tile") && check.tiles.empty())
    fail_usage("{}: is tile {} of a run over several inputs; name these and the folder of all tiles.", output.string(),
               *record->setting("tile"));
  if (!check.inputs.empty()) return check;
  if (!record) fail_usage("{}: does not say how it was made; name the inputs as well.", output.string());
  check.inputs = recorded_inputs(*record, output);
  return check;
}

/// Returns the cloud without the points that the run has dropped because of coordinates that are not finite, and the
/// rows of these points.
std::pair<InputCloud, NonfiniteRows> left_by_run(const OutputCheck& check, const InputCloud& all) {
  Outputs outputs{.tiles = check.tiles};
  if (check.tiles.empty()) outputs.points = check.output;
  if (nonfinite_rule(all, outputs, check.options.nonfinite) != Nonfinite::drop) return {all, {}};
  return all.finite();
}

void refuse_resorted(const OutputCheck& check, const ChainGraph& graph) {
  if (graph.has_order() && check.options.order != Order::input)
    fail_usage(
        "verify: rows in the order of moved points cannot be told from the input; verify an output in the order of the "
        "input, and say --order input.");
}

StageText knn_of(const OutputCheck& check) { return {neighborhood_declaration().name, check.neighborhood, "verify"}; }

/// Returns the run that made an array of neighbours or of distances. k is the number of columns of the array; the array
/// does not state a radius.
MadeBy made_by_neighbors(const OutputCheck& check, const InputCloud& cloud, const RowSource& out) {
  const std::vector<Field>& columns = out.schema().fields;
  const bool distances = columns.front().type == Type::f64;
  Chain chain = build_chain({knn_of(check)}, Facts{.points = cloud.count()});
  const bool k_given =
      std::ranges::any_of(check.neighborhood, [](const OptionText& option) { return option.name == "k"; });
  if (k_given && chain.neighborhood.k != columns.size())
    fail_usage("-k: the array has {} columns, and {} neighbours need as many.", columns.size(), chain.neighborhood.k);
  chain.neighborhood.k = columns.size();
  chain.stages = {std::make_shared<NeighborRows>(columns.size(), cloud.count(), distances)};
  chain.keep = {distances ? "distances" : "neighbors"};
  return made_by(plan_chain(chain, cloud.schema()));
}

/// The attributes of an output that the run has made: new attributes, and attributes of the input with changed values.
class MadeAttributes {
 public:
  MadeAttributes(const Schema& in, const Schema& out, const std::set<std::string>& changed)
      : in_(in), out_(out), changed_(changed) {}

  bool has(const std::string& field) const {
    const auto old = in_.find(field);
    return out_.find(field) && (!old || changed_.contains(in_.fields[*old].name));
  }
  bool has(const Attribute& attribute) const {
    return std::ranges::all_of(attribute.fields, [&](const std::string& field) { return has(field); });
  }
  /// Returns the stages that usually make the attributes of the output; empty if no stage is known for them.
  std::string likely_pipeline() const {
    std::string text;
    const bool curvature = has("k1") || has("k2") || has("mean_curvature") || has("surface_variation");
    if (has("nx") || curvature || has("splat_length")) text = "normals";
    if (curvature) text += " | curvature";
    if (has("splat_length")) text += " | splats";
    return text;
  }

 private:
  const Schema& in_;
  const Schema& out_;
  const std::set<std::string>& changed_;
};

/// The stages that made an output, and the rows of the input from which they made it.
struct Compared {
  MadeBy made;
  InputCloud from;
};

/// Returns the stages of the run and the rows that they take. `all`: the inputs; `cloud`: left_by_run() of `all`.
Compared made_by_pipeline(const OutputCheck& check, const InputCloud& all, const InputCloud& cloud, RowSource& out,
                          const std::set<std::string>& changed) {
  const VerifyOptions& options = check.options;
  const MadeAttributes attributes(cloud.schema(), out.schema(), changed);
  const std::string likely = attributes.likely_pipeline();
  std::vector<StageText> stages;
  if (!options.pipeline.empty())
    stages = parse_pipeline_or_file(options.pipeline);
  else if (!check.without_stages && !likely.empty())
    stages = parse_pipeline(likely);
  if (stages.empty() && options.keep.empty()) return {{}, cloud};
  const bool knn = !stages.empty() && stages.front().name == neighborhood_declaration().name;
  if (knn && !check.neighborhood.empty())
    fail_usage("verify: the pipeline says in knn which neighbours it takes; leave out {}.",
               check.neighborhood.front().name);
  if (!knn) stages.insert(stages.begin(), knn_of(check));
  Facts facts = facts_of(cloud);
  if (check.recorded) facts.metres_per_unit = 1;
  ChainPlan plan = plan_chain(build_chain(stages, facts, options.keep, options.prefix), cloud.schema());
  refuse_resorted(check, plan.graph);
  const bool all_are_dropped = plan.graph.drops && plan.made.empty();
  if (!options.keep.empty() || plan.graph.drops) plan.chain.keep = plan.kept.attributes;
  const bool is_numbered = plan.graph.reads_input_rows();
  const InputCloud read = is_numbered ? left_by_run(check, all.numbered()).first : cloud;
  KeptRows kept = rows_kept_first(options, read, plan.graph);
  Compared compared{made_by(plan), std::move(kept.cloud)};
  MadeBy& made = compared.made;
  made.before_means = std::move(kept.before_means);
  if (all_are_dropped) leave_selects(made);
  leave_out(plan.kept, options.prefix, cloud.schema(), made);
  made.left_out_input.insert(kInputRow);
  made.in_any_order = is_in_any_order(check);
  if (made.leaves_out && (options.order == Order::sweep || made.in_any_order))
    fail_usage(
        "verify: which rows a stage after others has left out is not told by an output in the order of the sweep, nor "
        "by one that is divided among files or a COPC file; verify one file in the order of the input.");
  // The threshold of outliers comes from the mean distances in the output, which are themselves checked against the
  // input.
  if (!made.leaves_out)
    made.outlier_threshold = outlier_threshold(out, made.operators, options.prefix, options.progress);
  if (!options.pipeline.empty() || !options.keep.empty()) return compared;
  for (const auto& op : made.operators)
    for (const Attribute& a : contract_of(op).makes)
      if (attributes.has(a)) made.keep.push_back(a.name);
  return compared;
}

/// Returns the attributes of the input whose values differ in the output for most points.
std::set<std::string> changed_attributes(const Arrivals& arrivals) {
  std::set<std::string> names;
  for (const AttributeArrival& a : arrivals.attributes)
    if (a.sum_in != a.sum_out && a.rows_different > arrivals.points_in / 2) names.insert(a.name);
  return names;
}

/// Checks files of points. `all`: the inputs; `cloud`: left_by_run() of `all`; `misplaced`: faults of the division into
/// files.
Verdict checked_points(const OutputCheck& check, const InputCloud& all, InputCloud& cloud, RowSource& out,
                       const Differences& misplaced) {
  const VerifyOptions& options = check.options;
  const Format* const format = format_of_output(check.first_file());
  const auto made_with = [&](const std::set<std::string>& changed) {
    Compared compared = made_by_pipeline(check, all, cloud, out, changed);
    MadeBy& made = compared.made;
    if (format != nullptr) {
      made.own_field = format->own_field, made.stored_name = format->stored_name;
      made.loses_nonfinite = format->loses_nonfinite;
    }
    made.in_any_order = is_in_any_order(check);
    made.known = misplaced;
    return compared;
  };
  Compared compared = made_with({});
  const Verdict verdict = verify(compared.from, out, false, compared.made, options);
  if (verdict.same() || !options.pipeline.empty()) return verdict;
  // Without a record, attributes that are in the input, for example normals, may have been computed again by the run.
  Compared likely = made_with(changed_attributes(verdict.arrivals));
  return likely.made.keep == compared.made.keep ? verdict : verify(likely.from, out, false, likely.made, options);
}

/// Checks the output. `all`: the inputs; `cloud`: left_by_run() of `all`.
Verdict checked(const OutputCheck& check, const InputCloud& all, InputCloud& cloud) {
  const VerifyOptions& options = check.options;
  if (is_array_name(check.output)) {
    const std::unique_ptr<Reader> array = array_format().open(check.output);
    RowSource out(*array);
    return verify(cloud, out, true, made_by_neighbors(check, cloud, out), options);
  }
  if (check.tiles.empty()) {
    const std::unique_ptr<Reader> file = open_reader(check.output);
    RowSource out(*file);
    return checked_points(check, all, cloud, out, {});
  }
  if (!check.is_divided()) {
    InputCloud tiles = InputCloud(check.tiles, {.ignore_crs = true}).with_unused_attributes();
    RowSource out(tiles, check.output.string(), "");
    return checked_points(check, all, cloud, out, {});
  }
  DividedOutput divided = read_divided(check.tiles, options.division, options.progress);
  RowSource out(divided.own, check.output.string(), options.division.tile_buffer > 0 ? kBuffer : "");
  return checked_points(check, all, cloud, out, divided.misplaced);
}
}  // namespace

Verdict verify(const std::vector<fs::path>& inputs, const fs::path& output, const VerifyOptions& options) {
  std::vector<OptionText> neighborhood;
  for (const Option& option : options.neighborhood)
    neighborhood.push_back({option.name, text_of_value(option.value), "verify"});
  const OutputCheck check = completed({inputs, output, options, neighborhood, {}, false});
  const InputCloud opened(check.inputs, check.options.cloud);
  // Each tile has the types of its own input, so the output is right even if the common type of all inputs does not
  // hold a value.
  const bool is_of_tiles = !check.tiles.empty() && !check.is_divided();
  const InputCloud all = is_of_tiles ? opened.with_unused_attributes() : opened;
  auto [cloud, dropped] = left_by_run(check, all);
  Verdict verdict = checked(check, all, cloud);
  verdict.dropped = dropped.count;
  verdict.points_of_inputs = all.count();
  return verdict;
}

}  // namespace pointsweep
