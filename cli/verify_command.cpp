// SPDX-License-Identifier: MIT
/// `pointsweep verify IN... OUT`: the user's own check of what a run has written.
#include <algorithm>
#include <fstream>
#include <set>
#include <string>

#include "cli/checked_stages.h"
#include "cli/cloud_run.h"
#include "cli/commands.h"
#include "cli/console.h"
#include "cli/not_checked.h"
#include "cli/pipeline_run.h"
#include "cli/progress.h"
#include "cli/quantities.h"
#include "cli/recorded_run.h"
#include "cli/stage_options.h"
#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/formats/cloud_reader.h"
#include "pointsweep/formats/input_list.h"
#include "pointsweep/formats/registry.h"
#include "pointsweep/operators/neighbor_rows.h"
#include "pointsweep/pipeline/build_chain.h"
#include "pointsweep/pipeline/finite_input.h"
#include "pointsweep/pipeline/length_units.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/verify/outlier_threshold.h"
#include "pointsweep/verify/verify.h"

namespace pointsweep {
namespace {

struct VerifyCommand {
  CommonOptions common;
  InputsAndOutput paths;
  std::string pipeline;
  bool recorded = false;  ///< the pipeline is that of the record, which names what is not a default in metres
  std::vector<OptionText> neighborhood;
  std::vector<std::string> keep;
  VerifyOptions check;
  Checksums checksums = Checksums::leave_out;
  std::vector<std::filesystem::path> tiles;  ///< an output for each input, if the output is a folder

  bool says_how() const { return !pipeline.empty() || !neighborhood.empty() || !keep.empty(); }
};

/// Whether this program has all operators of the pipeline. A program that uses the library may have others.
bool is_known(const std::string& pipeline) {
  try {
    build_chain(parse_pipeline(pipeline), Facts{});
    return true;
  } catch (const UsageError&) {
    return false;
  }
}

/// The pipeline and what it keeps. With operators that are not known here, inputs have to be named, and the attributes
/// found say what is checked.
void take_recorded_pipeline(VerifyCommand& command, const ProvenanceRecord& record) {
  const std::string pipeline = fmt::format("{}", fmt::join(record.stages, " | "));
  if (is_known(pipeline)) {
    command.pipeline = pipeline, command.recorded = true;
    if (record.setting("keep")) command.keep = parse_names(*record.setting("keep"));
  } else if (command.paths.files.size() == 1) {
    fail_usage(
        "{}: was made by '{}', of which not all operators are known here; name what was read, and last what was "
        "written: IN... OUT.",
        command.paths.output().string(), pipeline);
  }
}

/// What the output says of its run, where the command does not say it.
void take_record(VerifyCommand& command, const ProvenanceRecord& record) {
  const auto setting = [&](const char* name) { return record.setting(name).value_or(""); };
  if (command.common.prefix.empty()) command.common.prefix = setting("prefix");
  if (command.common.format.empty()) command.common.format = setting("format");
  if (command.common.nonfinite == Nonfinite::by_format && setting("nonfinite") == "drop")
    command.common.nonfinite = Nonfinite::drop;
  if (command.says_how()) return;
  const bool sorted = record.stages == std::vector<std::string>{"sort"};
  if (!sorted) take_recorded_pipeline(command, record);
  if (!command.check.order)
    command.check.order = setting("order") == "sweep" || sorted ? RowOrder::sweep : RowOrder::input;
  const std::string axis = setting("axis");
  if (!command.common.axis && axis.size() == 1 && axis >= "x" && axis <= "z") command.common.axis = axis[0] - 'x';
}

/// The output of an input in a folder of outputs, which may be of another format.
std::filesystem::path tile_of(const ListedFile& input, const std::filesystem::path& folder) {
  std::filesystem::path tile = folder / tile_name(input.relative, "");
  if (std::filesystem::exists(tile)) return tile;
  for (const std::string_view extension : writable_extensions())
    if (const auto other = folder / tile_name(input.relative, std::string(extension)); std::filesystem::exists(other))
      return other;
  fail("{}: is missing, the output for {}; was it moved, or is the run not complete?", tile.string(),
       input.path.string());
}

/// Replaces folders, patterns and .vpc files among the inputs by what they stand for; the output may be a folder.
void list_files(VerifyCommand& command) {
  const std::filesystem::path output = command.paths.output();
  const bool is_folder = std::filesystem::is_directory(output);
  if (command.paths.inputs_named() == 0 && is_folder)
    fail_usage("{}: is a folder; name the inputs too: pointsweep verify tiles/ {}.", output.string(), output.string());
  if (command.paths.inputs_named() == 0) return;
  const InputList inputs = list_inputs(command.paths.inputs(), command.paths.recursive, command.common.format);
  command.paths.files.clear();
  for (const ListedFile& input : inputs.files) {
    command.paths.files.push_back(input.path);
    if (is_folder) command.tiles.push_back(tile_of(input, output));
  }
  command.paths.files.push_back(output);
}

/// The command with its inputs and the record of the output.
VerifyCommand completed(VerifyCommand command) {
  if (command.paths.files.empty()) fail_usage("IN... OUT: name what was read, and last what was written.");
  const std::filesystem::path output = command.paths.output();
  list_files(command);
  const std::optional<ProvenanceRecord> record = recorded_run(command.tiles.empty() ? output : command.tiles.front());
  if (record) take_record(command, *record);
  if (record && record->setting("tile") && command.tiles.empty())
    fail_usage("{}: is tile {} of a run over several inputs; name these and the folder of all tiles: IN... OUT.",
               output.string(), *record->setting("tile"));
  if (command.paths.files.size() > 1) return command;
  if (!record)
    fail_usage("{}: does not say how it was made; name what was read, and last what was written: IN... OUT.",
               output.string());
  command.paths.files = recorded_inputs(*record, output);
  command.paths.files.push_back(output);
  return command;
}

/// Leaves out the points that the run has left out.
NonfiniteRows left_out(const VerifyCommand& command, InputCloud& cloud) {
  Outputs outputs{.tiles = command.tiles};
  if (command.tiles.empty()) outputs.points = command.paths.output();
  if (nonfinite_rule(cloud, outputs, command.common.nonfinite) != Nonfinite::drop) return {};
  return cloud.drop_nonfinite();
}

std::shared_ptr<InputCloud> opened_again(const VerifyCommand& command) {
  auto cloud = std::make_shared<InputCloud>(command.paths.inputs(), cloud_options(command.common));
  left_out(command, *cloud);
  return cloud;
}

void drop_nonfinite(const VerifyCommand& command, InputCloud& cloud) {
  const NonfiniteRows dropped = left_out(command, cloud);
  if (dropped.count > 0 && !command.common.quiet)
    print(
        fmt::format("left out     {} points of the input whose coordinates are not finite; rows count the others\n",
                    dropped.count));
}

void refuse_resorted(const VerifyCommand& command, const ChainGraph& graph) {
  if (graph.has(NodeKind::order) && command.check.order != RowOrder::input)
    fail_usage(
        "verify: rows in the order of moved points cannot be told from the input; verify an output in the order of the "
        "input, and say --order input.");
}

StageText knn_of(const VerifyCommand& command) {
  return {neighborhood_declaration().name, command.neighborhood, "verify"};
}

/// An array of neighbours or of distances says itself how it was made, but for a radius.
MadeBy made_by_neighbors(const VerifyCommand& command, const InputCloud& cloud, const Reader& out) {
  const std::vector<Field>& columns = out.info().schema.fields;
  const bool distances = columns.front().type == Type::f64;
  Chain chain = build_chain({knn_of(command)}, Facts{.points = cloud.count()});
  const bool k_given = std::any_of(command.neighborhood.begin(), command.neighborhood.end(),
                                   [](const OptionText& option) { return option.name == "k"; });
  if (k_given && chain.neighborhood.k != columns.size())
    fail_usage("-k: the array has {} columns, and {} neighbours need as many.", columns.size(), chain.neighborhood.k);
  chain.neighborhood.k = columns.size();
  chain.stages = {std::make_shared<NeighborRows>(columns.size(), cloud.count(), distances)};
  chain.keep = {distances ? "distances" : "neighbors"};
  return made_by(plan_chain(chain, cloud.schema()));
}

/// Which attributes of an output are not simply those of the input: new ones, and old ones that are `changed`.
class MadeAttributes {
 public:
  MadeAttributes(const Schema& in, const Schema& out, const std::set<std::string>& changed)
      : in_(in), out_(out), changed_(changed) {}

  bool has(const std::string& field) const {
    const auto old = in_.find(field);
    return out_.find(field) && (!old || changed_.contains(in_.fields[*old].name));
  }
  bool has(const Attribute& attribute) const {
    return std::all_of(attribute.fields.begin(), attribute.fields.end(),
                       [&](const std::string& field) { return has(field); });
  }
  /// The stages that usually make them.
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

MadeBy made_by_pipeline(const VerifyCommand& command, const VerifyOptions& options, InputCloud& cloud, Reader& out,
                        const std::set<std::string>& changed = {}) {
  const MadeAttributes attributes(cloud.schema(), out.info().schema, changed);
  const std::string likely = attributes.likely_pipeline();
  if (command.pipeline.empty() && likely.empty()) return {};
  std::vector<StageText> stages =
      command.pipeline.empty() ? parse_pipeline(likely) : parse_pipeline_or_file(command.pipeline);
  const bool knn = !stages.empty() && stages.front().name == neighborhood_declaration().name;
  if (knn && !command.neighborhood.empty())
    fail_usage("{}: the pipeline says in knn which neighbours it takes; leave the option out.",
               command.neighborhood.front().place);
  if (!knn) stages.insert(stages.begin(), knn_of(command));
  Facts facts = facts_of(cloud);
  if (command.recorded) facts.metres_per_unit = 1;
  ChainPlan plan = plan_chain(build_chain(stages, facts, command.keep, command.common.prefix), cloud.schema());
  refuse_resorted(command, plan.graph);
  const bool all_are_dropped = plan.graph.drops && plan.made.empty();
  if (!command.keep.empty() || plan.graph.drops) plan.chain.keep = plan.kept.attributes;
  const auto before_means = select_rows(options, cloud, plan.graph, [&] { return opened_again(command); });
  MadeBy made = made_by(plan);
  made.before_means = before_means;
  if (all_are_dropped) leave_selects(made);
  leave_out(plan.kept, command.common.prefix, cloud.schema(), made);
  // Outliers are compared with the mean distances in the output, which are compared with the input.
  if (made.leaves_out && command.check.order == RowOrder::sweep)
    fail_usage(
        "verify: which rows a stage behind others has left out is not told by an output in the order of the sweep; "
        "verify one in the order of the input.");
  if (!made.leaves_out)
    made.outlier_threshold = outlier_threshold(out, made.operators, options.prefix, options.progress);
  if (!command.pipeline.empty() || !command.keep.empty()) return made;
  for (const auto& op : made.operators)
    for (const Attribute& a : op->contract().makes)
      if (attributes.has(a)) made.keep.push_back(a.name);
  return made;
}

std::vector<std::uint64_t> rows_named_in(const std::string& path) {
  std::ifstream file(path);
  if (!file) fail_usage("--rows: cannot open {}.", path);
  std::vector<std::uint64_t> rows;
  for (std::string word; file >> word;) rows.push_back(parse_count("--rows", word));
  return rows;
}

VerifyOptions check_options(const VerifyCommand& command, ProgressDisplay& display) {
  VerifyOptions options = command.check;
  options.axis = command.common.axis;
  options.prefix = command.common.prefix;
  if (command.common.memory != 0) options.memory_bytes = command.common.memory;
  const std::filesystem::path& file = command.tiles.empty() ? command.paths.output() : command.tiles.front();
  if (const Format* const format = format_of_output(file)) options.own_field = format->own_field;
  options.progress = [&display](const char* phase, std::uint64_t done, std::uint64_t total) {
    stop_if_cancelled();
    display.report(phase, done, total);
  };
  return options;
}

/// Attributes of the input that most points have otherwise in the output.
std::set<std::string> changed_attributes(const Arrivals& arrivals) {
  std::set<std::string> names;
  for (const AttributeArrival& a : arrivals.attributes)
    if (a.sum_in != a.sum_out && a.rows_different > arrivals.points_in / 2) names.insert(a.name);
  return names;
}

Verdict checked(const VerifyCommand& command, InputCloud& cloud, ProgressDisplay& display) {
  const std::filesystem::path& path = command.paths.output();
  const VerifyOptions options = check_options(command, display);
  if (is_array_name(path)) {
    const std::unique_ptr<Reader> array = array_format().open(path);
    return verify(cloud, *array, true, made_by_neighbors(command, cloud, *array), options);
  }
  const std::unique_ptr<Reader> out =
      command.tiles.empty() ? open_reader(path)
                            : std::make_unique<CloudReader>(InputCloud(command.tiles, {.ignore_crs = true}), path);
  const MadeBy made = made_by_pipeline(command, options, cloud, *out);
  const Verdict verdict = verify(cloud, *out, false, made, options);
  if (verdict.same() || !command.pipeline.empty()) return verdict;
  // The user did not say what was made: normals, for example, that the input had may have been computed again.
  const MadeBy likely = made_by_pipeline(command, options, cloud, *out, changed_attributes(verdict.arrivals));
  return likely.keep == made.keep ? verdict : verify(cloud, *out, false, likely, options);
}

void run_check(const VerifyCommand& given) {
  take_standard_input(given.paths.files, given.common);
  const VerifyCommand command = completed(given);
  InputCloud cloud(command.paths.inputs(), cloud_options(command.common));
  drop_nonfinite(command, cloud);
  ProgressDisplay display(command.common);
  const Verdict verdict = checked(command, cloud, display);
  if (!command.common.quiet) print(to_text(verdict, command.checksums));
  if (!verdict.same()) fail("{}: {}.", conclusion(verdict), verdict.differences.front());
  if (!verdict.is_complete()) throw NotChecked(fmt::format("{}: {}.", verdict.output, conclusion(verdict)));
}

void add_check_options(CLI::App& verb, VerifyCommand& command) {
  verb.add_option_function<std::string>(
          "--sample", [&command](const std::string& text) { command.check.sample = parse_count("--sample", text); },
          "Number of points whose computed attributes are recomputed by brute force (default: 10000)")
      ->type_name("N");
  verb.add_option("--seed", command.check.seed, "Seed of the random choice of these points (default: 0)")
      ->type_name("S");
  verb.add_option_function<std::string>(
          "--rows", [&command](const std::string& path) { command.check.rows = rows_named_in(path); },
          "Additional points to recompute: row numbers from 0, separated by spaces or newlines")
      ->type_name("FILE");
  verb.add_option_function<std::string>(
          "--order",
          [&command](const std::string& name) {
            command.check.order = parse_order(name) == Order::sweep ? RowOrder::sweep : RowOrder::input;
          },
          "Order of the rows of the output (default: detected)")
      ->type_name("input|sweep");
  verb.add_flag_callback(
      "--checksums", [&command] { command.checksums = Checksums::show; },
      "Also show a checksum of the values of each attribute, which does not depend on the order of rows");
  add_axis_option(verb, command.common);
  add_nonfinite_option(verb, command.common);
  verb.add_option("--prefix", command.common.prefix, "The --prefix of the run")->type_name("NAME");
}

}  // namespace

void add_verify_command(CLI::App& app) {
  CLI::App& verb = *app.add_subcommand("verify", "Check a result by brute force, or compare two files");
  auto command = std::make_shared<VerifyCommand>();
  add_inputs_and_output(verb, command->paths, "file or folder that a run has written from them");
  add_neighborhood_options(verb, "", command->neighborhood);
  verb.add_option("--pipeline", command->pipeline,
                  "The pipeline of the run (default: the record in the output, or guessed from its attributes)")
      ->type_name("TEXT|FILE");
  add_keep_option(verb, command->keep, "The --keep of the run (default: all attributes)");
  add_check_options(verb, *command);
  add_memory_option(
      verb, command->common,
      "Memory for the neighbours of the sample; a larger sample is checked in several passes (default: 1G)");
  add_crs_option(verb, command->common);
  add_format_option(verb, command->common.format);
  add_progress_options(verb, command->common);
  verb.footer(
      "Compares every point and attribute of the input with the output. For a sample of points, finds the neighbours "
      "by\n"
      "brute force and recomputes the computed attributes by formulas that the run does not use. An output with a\n"
      "record of its run (see info) needs no options, and no inputs if these are in its folder or in the current one.\n"
      "Otherwise give the options of the run; --pipeline if normals were oriented, points moved or attributes "
      "replaced.\n"
      "Without computed attributes, two files are compared, whatever their formats and orders.\n"
      "Exit status: 0 if all was checked and is right, 1 if the output differs, 3 if not all could be checked and the\n"
      "rest is right.\n"
      "\nExample:\n"
      "  pointsweep verify normals.ply\n"
      "  pointsweep verify scan.ply normals.ply -k 12\n"
      "  pointsweep verify scan.ply out.las --pipeline 'knn(k=12) | normals(orient=up)' --sample 1000");
  verb.callback([command] { run_check(*command); });
}

}  // namespace pointsweep
