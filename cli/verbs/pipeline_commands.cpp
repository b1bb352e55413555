// SPDX-License-Identifier: MIT
/// The verbs that run pipelines:
/// - `pointsweep normals|curvature|splats|features|fair|denoise IN... OUT`: a fixed pipeline each, most of them from
///   the paper (Section 4.3);
/// - `pointsweep run IN... OUT --pipeline ...`: any chain of operators;
/// - `pointsweep convert IN... OUT`: a chain without operators;
/// - `pointsweep transform IN... OUT --matrix FILE`: moves the points by a matrix;
/// - `pointsweep ground IN... OUT`: classifies ground points; with --height, also computes heights above the ground;
/// - `pointsweep thin IN... OUT`: keeps fewer points, by one of the operators voxel, poisson, decimate and sample.
#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>

#include "cli/console/console.h"
#include "cli/verbs/cloud_run.h"
#include "cli/verbs/commands.h"
#include "pointsweep/chain.h"

namespace pointsweep {
namespace {

struct RunCommand {
  PipelineRun run;
  std::string pipeline;
};

struct ShortForm {
  const char* verb;
  const char* output;        ///< contents of OUT, after "with the attributes of the input" in the help
  const char* stages;        ///< stages of the pipeline after knn
  const char* with_options;  ///< stage, other than normals, whose options the verb takes as flags; empty for none
  const char* remark;
  const char* example;
};

constexpr ShortForm kShortForms[] = {
    {"normals", ", and nx, ny, nz", "normals", "", "A point whose neighbours define no plane gets the normal 0 0 0.",
     "Example: a scan of any size in 2 GB of memory, normals towards the scanner:\n"
     "  pointsweep normals scan.ply normals.ply -k 12 --memory 2G --orient viewpoint --viewpoint 0,0,1.7\n"
     "\nExample: a folder of tiles, into another folder without seams:\n"
     "  pointsweep normals tiles/ out/ -k 12"},
    {"curvature", ", and normals and curvatures", "normals | curvature", "",
     "'pointsweep operators curvature' lists the computed attributes.",
     "Example: the principal curvatures alone, beside the attributes of the input:\n"
     "  pointsweep curvature scan.ply curvature.ply -k 64 --keep k1,k2"},
    {"splats", ", and normals and splats", "normals | splats", "splats",
     "'pointsweep operators splats' lists the computed attributes.",
     "Example:\n"
     "  pointsweep splats scan.ply splats.ply -k 12"},
    {"features", ", and the features", "features", "features", "'pointsweep operators features' lists the formulas.",
     "Example: four features of the points within half a metre:\n"
     "  pointsweep features scan.las features.las --radius 0.5 --names linearity,planarity,verticality"},
    {"fair", ", and normals and splats of the moved points", "normals | splats | fair | normals | splats", "fair",
     "The output has the moved coordinates.",
     "Example:\n"
     "  pointsweep fair scan.ply smooth.ply -k 96 --f 0.3"},
    {"denoise", " of the points that stay", "denoise", "denoise",
     "'pointsweep operators sor' says which points are outliers.",
     "Example: a folder of tiles, into another one, with the rule of PCL:\n"
     "  pointsweep denoise tiles/ clean/ -k 50 --multiplier 1 --definition pcl"},
};

struct ShortFormCommand {
  PipelineRun run;
  std::vector<OptionText> neighborhood, options;
};

std::vector<StageText> stages_of(const ShortForm& form, const ShortFormCommand& command) {
  std::vector<StageText> stages = parse_pipeline(form.stages, form.verb);
  for (StageText& stage : stages)
    if (stage.name == form.with_options) stage.options = command.options;
  stages.insert(stages.begin(), {neighborhood_declaration().name, command.neighborhood, form.verb});
  return stages;
}

/// Returns the default number of neighbours of the verb's stages.
std::string default_k_of(const ShortForm& form) {
  const Chain chain = with_named_neighborhoods(build_chain(parse_pipeline(form.stages, form.verb), Facts{}));
  return fmt::format("{}", chain.neighborhood.k);
}

struct GroundCommand {
  PipelineRun run;
  std::vector<OptionText> options;
  bool height = false;
};

std::vector<StageText> ground_stages(const GroundCommand& command) {
  std::vector<StageText> stages = {{"ground", command.options, "ground"}};
  if (command.height) stages.push_back({"height", {}, "ground"});
  return stages;
}

struct TransformCommand {
  PipelineRun run;
  std::vector<OptionText> options;
};

/// Throws UsageError if no flag moves the points. The flag --scale sets the coordinate grid of the output and moves no
/// point.
void require_move(const TransformCommand& command) {
  const auto moves = [](const OptionText& option) { return option.name != "inverse"; };
  if (std::ranges::any_of(command.options, moves)) return;
  refuse(
      "transform: nothing says where the points go; give --matrix FILE or --translate X,Y,Z. To scale them write "
      "pointsweep run IN OUT --pipeline 'transform(scale=0.3048)'; --scale is the grid of LAS outputs.");
}

/// An option of an operator as a flag of the verb.
struct ThinningFlag {
  const char* flag;
  const char* stage;
  const char* option;  ///< option of the stage; the first flag of a stage has the main option, which selects the stage
};

constexpr ThinningFlag kThinningFlags[] = {
    {"--voxel", "voxel", "size"},        {"--voxel-keep", "voxel", "keep"},
    {"--poisson", "poisson", "radius"},  {"--radius-from", "poisson", "radius_from"},
    {"--decimate", "decimate", "share"}, {"--seed", "decimate", "seed"},
    {"--number", "sample", "number"},    {"--rest", "sample", "rest"}};

struct ThinCommand {
  PipelineRun run;
  std::vector<StageText> stages;  ///< all stages that thin, each with the options that flags give it
};

const OptionDeclaration& declared_option_of(const ThinningFlag& flag) {
  const auto& options = declaration_of(flag.stage)->options;
  return *std::ranges::find(options, std::string(flag.option), &OptionDeclaration::name);
}

/// Returns the flag that selects a thinning stage.
const char* flag_of(const StageText& stage) {
  return std::ranges::find(kThinningFlags, stage.name, &ThinningFlag::stage)->flag;
}

/// Moves the option --seed, which is parsed as an option of decimate, to the stage sample if points are sampled.
void move_seed(std::vector<StageText>& stages) {
  StageText& decimate = *std::ranges::find(stages, "decimate", &StageText::name);
  StageText& sample = *std::ranges::find(stages, "sample", &StageText::name);
  if (sample.options.empty()) return;
  for (const OptionText& option : decimate.options)
    if (option.name == "seed") sample.options.push_back(option);
  std::erase_if(decimate.options, [](const OptionText& option) { return option.name == "seed"; });
}

/// Returns the stage whose main option is given. Throws UsageError unless the main option of exactly one stage is
/// given, and for options of any other stage.
std::vector<StageText> thinning_stages(const ThinCommand& command) {
  std::vector<StageText> stages = command.stages;
  move_seed(stages);
  std::erase_if(stages, [](const StageText& stage) { return stage.options.empty(); });
  const auto first_of = [](const StageText& stage) { return declaration_of(stage.name)->options.front().name; };
  const auto says_how = [&](const StageText& stage) { return gives(stage.options, first_of(stage)); };
  if (std::ranges::count_if(stages, says_how) != 1)
    refuse("thin: give one of --voxel SIZE, --poisson RADIUS, --decimate SHARE and --number N.");
  for (const StageText& stage : stages)
    if (!says_how(stage))
      refuse("{0}: belongs to {1}; leave it out, or use {1}.", stage.options[0].place, flag_of(stage));
  return stages;
}

}  // namespace

void declare_run_verb(CLI::App& verb) {
  auto command = std::make_shared<RunCommand>();
  add_inputs_and_output(verb, command->run.paths,
                        "with the attributes of the input, and the computed ones (in a folder, one for each input)");
  verb.add_option("--pipeline", command->pipeline,
                  "Stages such as 'knn(k=12) | normals', or a .json file of them (default: none, which is 'pointsweep "
                  "convert')")
      ->type_name("TEXT|FILE");
  add_pipeline_options(verb, command->run);
  verb.footer(
      "'pointsweep operators' lists the operators and their options. As JSON, a pipeline is an array of stages:\n"
      "  [{\"type\": \"knn\", \"k\": 12}, {\"type\": \"normals\", \"orient\": \"viewpoint\", \"viewpoint\": [0, 0, "
      "1.7]}]\n"
      "\nExamples:\n"
      "  pointsweep run scan.ply out.ply --pipeline 'knn(k=12) | normals(orient=up)' --memory 2G\n"
      "  pointsweep run scan.ply out.ply --pipeline 'normals(orient=viewpoint, viewpoint=[0,0,1.7])'");
  verb.callback([command] {
    if (command->pipeline.empty()) return run_stages({}, command->run);
    if (command->pipeline.ends_with(".json")) command->run.paths.other_inputs.emplace_back(command->pipeline);
    run_stages(parse_pipeline_or_file(command->pipeline), command->run);
  });
}

void declare_convert_verb(CLI::App& verb) {
  auto command = std::make_shared<PipelineRun>();
  add_inputs_and_output(verb, command->paths,
                        "with the attributes of the input, in its order (in a folder, one for each input)");
  add_output_options(verb, *command);
  verb.footer(
      "Points of several inputs follow one another. Nothing is searched, so any number of points streams through a few "
      "megabytes. Same as 'pointsweep run' without a pipeline.\n"
      "\nExamples: a scan as LAZ with steps of a millimetre, tiles as one file, and a folder of E57 as LAZ:\n"
      "  pointsweep convert scan.ply scan.laz --scale 0.001\n"
      "  pointsweep convert tiles/ merged.laz\n"
      "  pointsweep convert scans/ out/ --output-format laz");
  verb.callback([command] { run_stages({}, *command); });
}

void declare_short_form(CLI::App& verb) {
  const ShortForm& form = *std::ranges::find(kShortForms, verb.get_name(), &ShortForm::verb);
  auto command = std::make_shared<ShortFormCommand>();
  const std::string k = default_k_of(form);
  const std::string output =
      fmt::format("with the attributes of the input{} (in a folder, one for each input)", form.output);
  add_inputs_and_output(verb, command->run.paths, output);
  add_neighborhood_options(verb, k, command->neighborhood);
  if (const OperatorDeclaration* own = declaration_of(form.with_options))
    add_stage_options(verb, own->options, command->options);
  const bool has_normals = std::string_view(form.stages).starts_with("normals");
  has_normals ? add_pipeline_options(verb, command->run) : add_output_options(verb, command->run);
  verb.footer(fmt::format("Same as 'pointsweep run' with the pipeline 'knn(k={}) | {}'. {}\n\n{}", k, form.stages,
                          form.remark, form.example));
  verb.callback([&form, command] { run_stages(stages_of(form, *command), command->run); });
}

void declare_ground_verb(CLI::App& verb) {
  auto command = std::make_shared<GroundCommand>();
  add_inputs_and_output(verb, command->run.paths,
                        "with the attributes of the input, and classification (in a folder, one for each input)");
  add_stage_options(verb, declaration_of("ground")->options, command->options);
  verb.add_flag("--height", command->height, "Also make height, above the nearest point of the ground in the plane");
  add_output_options(verb, command->run);
  verb.footer(
      "Same as 'pointsweep run' with the pipeline 'ground' or 'ground | height'. Lengths are in the unit of the cloud; "
      "the defaults are in metres, and converted where the coordinate system says that the unit is feet.\n"
      "\nExample: ground of a folder of tiles, without seams, and heights above it:\n"
      "  pointsweep ground tiles/ out/ --cell 0.5 --window 15 --height");
  verb.callback([command] { run_stages(ground_stages(*command), command->run); });
}

void declare_transform_verb(CLI::App& verb) {
  auto command = std::make_shared<TransformCommand>();
  add_inputs_and_output(verb, command->run.paths,
                        "with the attributes of the input and the moved coordinates (in a folder, one for each input)");
  for (const OptionDeclaration& option : declaration_of("transform")->options)
    if (option.name != "inverse" && option.name != "scale")
      add_stage_option(verb, "--" + option.name, option, command->options);
  verb.add_flag_function(
      "--inverse",
      [command](std::int64_t) {
        command->options.push_back({"inverse", "yes", "--inverse"});
      },
      "Move the points back: by the inverse of the matrix");
  add_output_options(verb, command->run);
  verb.footer(
      "Same as 'pointsweep run' with the pipeline 'transform(FILE)'. The file has 4 lines of 4 numbers, the last one 0 "
      "0 "
      "0 1, as CloudCompare, Open3D and numpy.savetxt write them. 'pointsweep operators transform' has the formula.\n"
      "\nExample: a scan into the place of another one, as a registration has found it, and back:\n"
      "  pointsweep transform scan.ply placed.ply --matrix registration.txt\n"
      "  pointsweep transform placed.ply back.ply --matrix registration.txt --inverse");
  verb.callback([command] {
    require_move(*command);
    run_stages({{"transform", command->options, "transform"}}, command->run);
  });
}

void declare_thin_verb(CLI::App& verb) {
  auto command = std::make_shared<ThinCommand>();
  add_inputs_and_output(verb, command->run.paths,
                        "with the attributes of the input, of fewer points (in a folder, one for each input)");
  for (const char* name : {"voxel", "poisson", "decimate", "sample"}) command->stages.push_back({name, {}, "thin"});
  for (const ThinningFlag& flag : kThinningFlags) {
    StageText& stage = *std::ranges::find(command->stages, std::string(flag.stage), &StageText::name);
    add_stage_option(verb, flag.flag, declared_option_of(flag), stage.options);
  }
  verb.add_option_function<std::string>(
          "--choose",
          [command](const std::string& keep) {
            report(Severity::note, "--choose is called --voxel-keep now; the next release does not know the old name.");
            command->stages.front().options.push_back({"keep", keep, "--choose"});
          })
      ->group("");
  add_output_options(verb, command->run);
  verb.footer(
      "Same as 'pointsweep run' with the pipeline 'voxel(SIZE)', 'poisson(RADIUS)', 'decimate(SHARE)' or 'sample(N)'. "
      "All but the last give of tiles the points of the merged cloud; a number is that of all inputs together.\n"
      "\nExample: one point in each cube of half a metre:\n"
      "  pointsweep thin scan.ply thin.ply --voxel 0.5\n"
      "\nExample: no two points within 20 cm, of a folder of tiles, into another one:\n"
      "  pointsweep thin tiles/ out/ --poisson 0.2");
  verb.callback([command] { run_stages(thinning_stages(*command), command->run); });
}

}  // namespace pointsweep
