// SPDX-License-Identifier: MIT
/// `pointsweep ground IN... OUT`: which points are ground, and how high the others are above it.
#include <memory>

#include "cli/verbs/commands.h"
#include "cli/verbs/pipeline_run.h"
#include "cli/verbs/stage_options.h"

namespace pointsweep {
namespace {

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

}  // namespace

void add_ground_command(CLI::App& app) {
  CLI::App& verb = *app.add_subcommand("ground", "Find the points of the ground by a morphological filter (SMRF)");
  auto command = std::make_shared<GroundCommand>();
  add_inputs_and_output(verb, command->run.paths,
                        "with the attributes of the input, and classification (in a folder, one for each input)");
  add_output_option(verb, command->run.paths.named_output);
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

}  // namespace pointsweep
