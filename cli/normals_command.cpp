// SPDX-License-Identifier: MIT
/// `pointsweep normals IN... OUT`: the cloud with a unit normal for each point.
#include <optional>

#include "cli/cloud_run.h"
#include "cli/commands.h"
#include "cli/quantities.h"
#include "pointsweep/error.h"
#include "pointsweep/operators/normals.h"

namespace pointsweep {
namespace {

constexpr std::size_t kDefaultNeighbors = 8;

struct NormalsCommand {
  CommonOptions common;
  InputsAndOutput paths;
  std::optional<std::uint64_t> k;
  std::optional<double> radius;
  NormalsOptions normals;
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

Neighborhood neighborhood_of(const NormalsCommand& command) {
  Neighborhood neighborhood;
  neighborhood.k = command.radius ? Neighborhood::kUnlimited : kDefaultNeighbors;
  if (command.k) neighborhood.k = *command.k;
  if (command.radius) neighborhood.radius = *command.radius;
  return neighborhood;
}

void normals(const NormalsCommand& command) {
  run_over_cloud(command.paths, command.common, [&](Cloud& cloud, const RunOptions& options) {
    const Chain chain{neighborhood_of(command), {std::make_shared<Normals>(command.normals)}};
    return run(cloud, chain, {.points = command.paths.output(), .arrays = {}, .writer = {}}, options);
  });
}

}  // namespace

void add_normals_command(CLI::App& app) {
  CLI::App& verb = *app.add_subcommand("normals", "Compute the normal of every point from its exact neighbours");
  auto command = std::make_shared<NormalsCommand>();
  add_inputs_and_output(verb, command->paths, "the file to write: all attributes of the input, and nx ny nz");
  verb.add_option_function<std::string>(
          "-k", [command](const std::string& text) { command->k = parse_count("-k", text); },
          "Neighbours to look at, the point itself not counted (default: 8, all with --radius)")
      ->type_name("N");
  verb.add_option("--radius", command->radius, "Look no farther than this; with -k, at the k nearest within it")
      ->type_name("D");
  verb.add_option_function<std::string>(
          "--orient", [command](const std::string& text) { parse_orientation(text, command->normals); },
          "Side to point to: none (default), up, viewpoint X,Y,Z (towards it), input (as normals already there)")
      ->type_name("HOW");
  add_order_option(verb, command->common);
  add_run_options(verb, command->common);
  verb.footer(
      "A point whose neighbours define no plane gets the normal 0 0 0.\n"
      "\nExample: a scan of any size in 2 GB of memory, normals towards the scanner:\n"
      "  pointsweep normals scan.ply normals.ply -k 12 --memory 2G --orient viewpoint 0,0,1.7");
  verb.callback([command] { normals(*command); });
}

}  // namespace pointsweep
