// SPDX-License-Identifier: MIT
/// `pointsweep run IN... OUT --pipeline ...`: any chain of operators in one sweep.
#include <string>

#include "cli/verbs/commands.h"
#include "cli/verbs/pipeline_run.h"
#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

struct RunCommand {
  PipelineRun run;
  std::string pipeline;
};

}  // namespace

void add_run_command(CLI::App& app) {
  CLI::App& verb = *app.add_subcommand("run", "Run a pipeline of operators over the points");
  auto command = std::make_shared<RunCommand>();
  add_inputs_and_output(verb, command->run.paths,
                        "with the attributes of the input, and the computed ones (in a folder, one for each input)");
  add_output_option(verb, command->run.paths.named_output);
  verb.add_option("--pipeline", command->pipeline, "Stages such as 'knn(k=12) | normals', or a .json file of them")
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
    if (command->pipeline.empty())
      fail_usage("run: --pipeline is missing; to copy or merge files write --pipeline 'decimate(1)'.");
    if (command->pipeline.ends_with(".json")) command->run.paths.other_inputs.emplace_back(command->pipeline);
    run_stages(parse_pipeline_or_file(command->pipeline), command->run);
  });
}

}  // namespace pointsweep
