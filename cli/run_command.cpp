// SPDX-License-Identifier: MIT
/// `pointsweep run IN... OUT --pipeline ...`: any chain of operators in one sweep.
#include <string>
#include <vector>

#include "cli/cloud_run.h"
#include "cli/commands.h"
#include "pointsweep/error.h"
#include "pointsweep/pipeline/build_chain.h"
#include "pointsweep/pipeline/preview.h"

namespace pointsweep {
namespace {

struct RunCommand {
  CommonOptions common;
  InputsAndOutput paths;
  std::string pipeline;
  std::vector<std::string> keep;
  bool dry = false;
};

std::vector<std::string> parse_names(const std::string& text) {
  std::vector<std::string> names(1);
  for (const char c : text) c == ',' ? void(names.emplace_back()) : names.back().push_back(c);
  for (const std::string& name : names)
    if (name.empty()) fail_usage("--keep: '{}' is not a list of attributes such as normal,splat_length.", text);
  return names;
}

void run_pipeline(const RunCommand& command) {
  const std::vector<StageText> stages = parse_pipeline_or_file(command.pipeline);
  if (command.dry) {
    look_at_cloud(command.paths, command.common, [&](Cloud& cloud, const RunOptions& options) {
      fmt::print("{}", to_text(preview(cloud, build_chain(stages, cloud, command.keep), options)));
    });
    return;
  }
  run_over_cloud(command.paths, command.common, [&](Cloud& cloud, const RunOptions& options) {
    const Chain chain = build_chain(stages, cloud, command.keep);
    return run(cloud, chain, {.points = command.paths.output(), .arrays = {}, .writer = {}}, options);
  });
}

}  // namespace

void add_run_command(CLI::App& app) {
  CLI::App& verb = *app.add_subcommand("run", "Run a pipeline of operators over the points in one sweep");
  auto command = std::make_shared<RunCommand>();
  add_inputs_and_output(verb, command->paths, "the file to write: all attributes of the input, and what is made");
  verb.add_option("--pipeline", command->pipeline, "Stages such as 'knn(k=12) | normals', or a .json file of them")
      ->type_name("TEXT|FILE")
      ->required();
  verb.add_option_function<std::string>(
          "--keep", [command](const std::string& text) { command->keep = parse_names(text); },
          "Made attributes to write, e.g. normal (default: all)")
      ->type_name("A,B,...");
  verb.add_flag("--dry-run", command->dry, "Say what would be done and how much memory it takes; write nothing");
  add_order_option(verb, command->common);
  add_run_options(verb, command->common);
  verb.footer(
      "'pointsweep operators' lists the stages there are. As JSON, a pipeline is an array of them:\n"
      "  [{\"type\": \"knn\", \"k\": 12}, {\"type\": \"normals\", \"orient\": \"up\"}]\n"
      "\nExample:\n"
      "  pointsweep run scan.ply out.ply --pipeline 'knn(k=12) | normals(orient=up)' --memory 2G");
  verb.callback([command] { run_pipeline(*command); });
}

}  // namespace pointsweep
