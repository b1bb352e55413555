// SPDX-License-Identifier: MIT
/// `pointsweep normals IN... OUT`: the cloud with a unit normal for each point.
#include "cli/cloud_run.h"
#include "cli/commands.h"
#include "cli/quantities.h"
#include "cli/stage_options.h"
#include "pointsweep/error.h"
#include "pointsweep/operators/normals.h"

namespace pointsweep {
namespace {

constexpr const char* kDefaultNeighbors = "8";

struct NormalsCommand {
  CommonOptions common;
  InputsAndOutput paths;
  std::vector<OptionText> neighborhood;
  NormalsOptions normals;
  std::string orientation = "none";  ///< as it was given
};

/// "none", "up", "input" or "viewpoint X,Y,Z"
void parse_orientation(const std::string& text, NormalsOptions& normals) {
  const std::string viewpoint = "viewpoint ";
  if (text == "none") {
    normals.orient = Orient::none;
  } else if (text == "up") {
    normals.orient = Orient::up;
  } else if (text == "input") {
    normals.orient = Orient::input;
  } else if (text.starts_with(viewpoint)) {
    normals.orient = Orient::viewpoint;
    normals.viewpoint = parse_vector("--orient viewpoint", text.substr(viewpoint.size()));
  } else {
    fail_usage("--orient: '{}' is not none, up, viewpoint X,Y,Z or input.", text);
  }
}

void normals(const NormalsCommand& command) {
  const StageText stage = neighborhood_stage(command.neighborhood, kDefaultNeighbors, "normals");
  const Neighborhood neighborhood = make_neighborhood(OptionValues(neighborhood_declaration().options, stage));
  run_over_cloud(command.paths, command.common, [&](Cloud& cloud, RunOptions options) {
    const Chain chain{neighborhood, {std::make_shared<Normals>(command.normals)}};
    options.resume_key = to_text(std::vector<StageText>{stage}) + " | normals oriented " + command.orientation;
    return run(cloud, chain, {.points = command.paths.output(), .arrays = {}, .writer = {}}, options);
  });
}

}  // namespace

void add_normals_command(CLI::App& app) {
  CLI::App& verb = *app.add_subcommand("normals", "Compute the normal of every point from its exact neighbours");
  auto command = std::make_shared<NormalsCommand>();
  add_inputs_and_output(verb, command->paths, "the file to write: all attributes of the input, and nx ny nz");
  add_output_option(verb, command->paths.named_output);
  add_neighborhood_options(verb, kDefaultNeighbors, command->neighborhood);
  verb.add_option_function<std::string>(
          "--orient",
          [command](const std::string& text) { parse_orientation(command->orientation = text, command->normals); },
          "Side to point to: none (default), up, viewpoint X,Y,Z (towards it), input (as normals already there)")
      ->type_name("HOW");
  add_order_option(verb, command->common);
  add_engine_option(verb, command->common);
  add_run_options(verb, command->common);
  verb.footer(
      "A point whose neighbours define no plane gets the normal 0 0 0.\n"
      "\nExample: a scan of any size in 2 GB of memory, normals towards the scanner:\n"
      "  pointsweep normals scan.ply normals.ply -k 12 --memory 2G --orient viewpoint 0,0,1.7");
  verb.callback([command] { normals(*command); });
}

}  // namespace pointsweep
