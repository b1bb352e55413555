// SPDX-License-Identifier: MIT
/// `pointsweep thin IN... OUT`: fewer points, by one of the operators voxel, poisson and decimate.
#include <algorithm>
#include <memory>
#include <string>

#include "cli/console/console.h"
#include "cli/verbs/commands.h"
#include "cli/verbs/pipeline_run.h"
#include "cli/verbs/stage_options.h"
#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

/// An option of an operator as a flag of the verb.
struct ThinningFlag {
  const char* flag;
  const char* stage;
  const char* option;  ///< the first of a stage says that it is the one
};

constexpr ThinningFlag kThinningFlags[] = {
    {"--voxel", "voxel", "size"},        {"--voxel-keep", "voxel", "keep"},
    {"--poisson", "poisson", "radius"},  {"--radius-from", "poisson", "radius_from"},
    {"--decimate", "decimate", "share"}, {"--seed", "decimate", "seed"}};

struct ThinCommand {
  PipelineRun run;
  std::vector<StageText> stages;  ///< as the flags name them, each with the options given
};

const OptionDeclaration& declared_option_of(const ThinningFlag& flag) {
  const auto& options = declaration_of(flag.stage)->options;
  return *std::ranges::find(options, std::string(flag.option), &OptionDeclaration::name);
}

/// The stage with its first option; of options that stand beside it alone, or of two such stages, there is no sense.
std::vector<StageText> thinning_stages(const ThinCommand& command) {
  std::vector<StageText> stages = command.stages;
  std::erase_if(stages, [](const StageText& stage) { return stage.options.empty(); });
  const auto first_of = [](const StageText& stage) { return declaration_of(stage.name)->options.front().name; };
  const auto says_how = [&](const StageText& stage) {
    return std::ranges::find(stage.options, first_of(stage), &OptionText::name) != stage.options.end();
  };
  if (std::ranges::count_if(stages, says_how) != 1)
    fail_usage("thin: give one of --voxel SIZE, --poisson RADIUS and --decimate SHARE.");
  for (const StageText& stage : stages)
    if (!says_how(stage))
      fail_usage("{0}: belongs to --{1}; leave it out, or use --{1}.", stage.options[0].place, stage.name);
  return stages;
}

}  // namespace

void add_thin_command(CLI::App& app) {
  CLI::App& verb = *app.add_subcommand("thin", "Keep fewer points: one in each voxel, at a distance, or a share");
  auto command = std::make_shared<ThinCommand>();
  add_inputs_and_output(verb, command->run.paths,
                        "with the attributes of the input, of fewer points (in a folder, one for each input)");
  add_output_option(verb, command->run.paths.named_output);
  for (const char* name : {"voxel", "poisson", "decimate"}) command->stages.push_back({name, {}, "thin"});
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
      "Same as 'pointsweep run' with the pipeline 'voxel(SIZE)', 'poisson(RADIUS)' or 'decimate(SHARE)'. Tiles give "
      "the points of the merged cloud.\n"
      "\nExample: one point in each cube of half a metre:\n"
      "  pointsweep thin scan.ply thin.ply --voxel 0.5\n"
      "\nExample: no two points within 20 cm, of a folder of tiles, into another one:\n"
      "  pointsweep thin tiles/ out/ --poisson 0.2");
  verb.callback([command] { run_stages(thinning_stages(*command), command->run); });
}

}  // namespace pointsweep
