// SPDX-License-Identifier: MIT
/// The common part of the verbs that run a pipeline of named operators, and options of stages as flags of a verb:
/// names, ranges, meanings and defaults come from their declarations.
#include <fmt/format.h>

#include <algorithm>

#include "cli/console/console.h"
#include "cli/text/help.h"
#include "cli/verbs/cloud_run.h"

namespace pointsweep {
namespace {

/// Returns the placeholder of the value in the help.
std::string value_name(const OptionDeclaration& option) {
  switch (option.kind) {
    case OptionKind::whole:
      return "N";
    case OptionKind::number:
      return option.unit == "length" ? "LENGTH" : "NUMBER";
    case OptionKind::point:
      return "X,Y,Z";
    case OptionKind::names:
      return "NAME,...";
    case OptionKind::attribute:
      return "NAME";
    case OptionKind::condition:
      return "CONDITION";
    case OptionKind::numbers:
      return "NUMBER,...";
    case OptionKind::file:
      return "FILE";
    case OptionKind::matrix:
      return "FILE|NUMBERS";
    case OptionKind::attributes:
      return "NAME,...";
    case OptionKind::assignments:
      return "ASSIGNMENTS";
    case OptionKind::word:
      return "WORD";
    case OptionKind::choice:
      break;
  }
  return fmt::format("{}", fmt::join(option.choices, "|"));
}

/// Returns the help of an option: "Number of neighbours, excluding the point (1 or more; default: 8)".
std::string help_of(const OptionDeclaration& option, const std::string& preset) {
  const std::string meaning = capitalized(option.meaning);
  std::string range;
  if (option.kind == OptionKind::whole || option.kind == OptionKind::number || option.kind == OptionKind::names)
    range = option.allowed();
  if (!preset.empty()) range += (range.empty() ? "default: " : "; default: ") + preset;
  return range.empty() ? meaning : fmt::format("{} ({})", meaning, range);
}

CLI::Option* add_option(CLI::App& verb, const std::string& flag, const OptionDeclaration& option,
                        const std::string& preset, std::vector<OptionText>& into) {
  return verb
      .add_option_function<std::string>(
          flag,
          [&into, flag, name = option.name](const std::string& value) {
            into.push_back({name, value, flag});
          },
          help_of(option, preset))
      ->type_name(value_name(option));
}

std::string flag_of(std::string name) {
  std::replace(name.begin(), name.end(), '_', '-');
  return "--" + name;
}

/// Throws UsageError for --orient viewpoint without --viewpoint, which is a separate flag.
void require_viewpoint(const std::vector<OptionText>& orientation) {
  const auto orient = std::ranges::find(orientation, "orient", &OptionText::name);
  if (orient != orientation.end() && orient->value == "viewpoint" && !gives(orientation, "viewpoint"))
    refuse("--orient viewpoint needs the position of the scanner; add --viewpoint X,Y,Z.");
}

Outputs outputs_of(const ResolvedFiles& files) {
  if (!files.tiles.empty()) return {.tiles = files.tiles};
  return {.points = files.output};
}

}  // namespace

bool gives(const std::vector<OptionText>& options, std::string_view name) {
  return std::ranges::find(options, name, &OptionText::name) != options.end();
}

void add_stage_options(CLI::App& verb, const std::vector<OptionDeclaration>& options, std::vector<OptionText>& into) {
  for (const OptionDeclaration& option : options)
    add_option(verb, flag_of(option.name), option, text_of_value(option.preset), into);
}

void add_stage_option(CLI::App& verb, const std::string& flag, const OptionDeclaration& option,
                      std::vector<OptionText>& into) {
  add_option(verb, flag, option, text_of_value(option.preset), into);
}

void add_neighborhood_options(CLI::App& verb, const std::string& k, std::vector<OptionText>& into) {
  for (const OptionDeclaration& option : neighborhood_declaration().options) {
    const bool is_k = option.name == "k";
    add_option(verb, is_k ? "-k" : flag_of(option.name), option, is_k ? k : text_of_value(option.preset), into)
        ->group(kNeighborGroup);
  }
}

void add_pipeline_options(CLI::App& verb, PipelineRun& run) {
  add_stage_options(verb, declaration_of("normals")->options, run.orientation);
  add_output_options(verb, run);
}

void add_output_options(CLI::App& verb, PipelineRun& run) {
  add_named_options(verb, run.common, {"tile", "tile_origin", "tile_buffer", "split"});
  add_file_options(verb, run);
}

void add_file_options(CLI::App& verb, PipelineRun& run) {
  add_output_format_option(verb, run.paths.output_format);
  add_keep_option(verb, run.common.keep, kKeepMeaning);
  add_named_options(verb, run.common,
                    {"order", "engine", "positions", "scale", "offset", "point_format", "las_version", "decimals",
                     "replace", "prefix", "provenance", "no_provenance"});
  add_stated_crs_options(verb, run.common);
  add_run_options(verb, run.common);
  add_cluster_options(verb, run.common.cluster);
}

void orient_normals(std::vector<StageText>& stages, const std::vector<OptionText>& orientation) {
  if (orientation.empty()) return;
  require_viewpoint(orientation);
  bool any = false;
  for (StageText& stage : stages) {
    if (stage.name != "normals") continue;
    if (gives(stage.options, "orient") || gives(stage.options, "viewpoint"))
      refuse("{}: normals has an orientation in the pipeline; leave out --orient or that one.", stage.place);
    stage.options.insert(stage.options.end(), orientation.begin(), orientation.end());
    any = true;
  }
  if (!any)
    refuse("{0}: the pipeline makes no normals; add the stage normals, or leave out {0}.", orientation.front().place);
}

void run_stages(std::vector<StageText> stages, const PipelineRun& command) {
  orient_normals(stages, command.orientation);
  const Chain known = build_chain(stages, Facts{});  // wrong names and options are refused before files are opened
  if (!stages.empty()) require_operators(known);
  const ClusterOptions& cluster = command.common.cluster;
  if (!cluster.dask.empty())
    run_on_cluster(stages.empty() ? std::vector<std::string>() : canonical_stages(known, Presets::left_out), command);
  if (!cluster.scratch.empty() || cluster.take_over)
    refuse("--scratch and --take-over: are for the workers of --dask; name a scheduler, or 'local'.");
  const auto chain_for = [&](const Cloud& cloud) {
    return build_chain(stages, cloud, command.common.keep, command.common.prefix);
  };
  run_over_cloud(
      command.paths, command.common,
      {.run = [&](Cloud& cloud, const ResolvedFiles& files,
                  const RunOptions& options) { return run(cloud, chain_for(cloud), outputs_of(files), options); },
       .plan =
           [&](Cloud& cloud, const ResolvedFiles& files, const RunOptions& options) {
             return plan_text(cloud, chain_for(cloud), outputs_of(files), options);
           }});
}

}  // namespace pointsweep
