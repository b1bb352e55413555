// SPDX-License-Identifier: MIT
/// `pointsweep neighbors IN... OUT.npy`: the exact k-nearest-neighbour graph as a NumPy array.
#include <optional>

#include "cli/cloud_run.h"
#include "cli/commands.h"
#include "cli/quantities.h"
#include "pointsweep/error.h"
#include "pointsweep/operators/neighbor_rows.h"

namespace pointsweep {
namespace {

struct NeighborsCommand {
  CommonOptions common;
  InputsAndOutput paths;
  std::size_t k = 8;
  std::optional<double> radius;
  std::filesystem::path distances;
};

void require_npy(const std::filesystem::path& path) {
  if (path.extension() != ".npy") fail_usage("{}: the graph is a NumPy array; name a .npy file.", path.string());
}

void neighbors(const NeighborsCommand& command) {
  InputsAndOutput paths = command.paths;
  paths.other_outputs.push_back(command.distances);
  require_named_files(paths);
  require_npy(paths.output());
  if (!command.distances.empty()) require_npy(command.distances);
  run_over_cloud(paths, command.common, [&](Cloud& cloud, const RunOptions& options) {
    const bool distances = !command.distances.empty();
    Neighborhood neighborhood;
    neighborhood.k = command.k;
    if (command.radius) neighborhood.radius = *command.radius;
    Outputs outputs{.points = {}, .arrays = {{"neighbors", command.paths.output()}}, .writer = {}};
    if (distances) outputs.arrays.emplace_back("distances", command.distances);
    const Chain chain{neighborhood, {std::make_shared<NeighborRows>(command.k, cloud.count(), distances)}};
    return run(cloud, chain, outputs, options);
  });
}

}  // namespace

void add_neighbors_command(CLI::App& app) {
  CLI::App& verb = *app.add_subcommand("neighbors", "Find the exact nearest neighbours of every point");
  auto command = std::make_shared<NeighborsCommand>();
  add_inputs_and_output(verb, command->paths, "the .npy file to write, n rows of k input rows, nearest first");
  add_output_option(verb, command->paths.named_output);
  verb.add_option_function<std::string>(
          "-k", [command](const std::string& text) { command->k = parse_count("-k", text); },
          "Neighbours of each point, itself not counted (default: 8)")
      ->type_name("N");
  verb.add_option("--radius", command->radius, "Leave out neighbours farther than this")->type_name("D");
  verb.add_option("--distances", command->distances, "Write the distances to them to this .npy file, float64")
      ->type_name("FILE");
  add_engine_option(verb, command->common);
  add_run_options(verb, command->common);
  verb.footer(
      "Rows run through the inputs in the order given, from 0. Equal distances are ordered by x, y, z, then row. "
      "Where\n"
      "there are fewer than k neighbours the rest is the largest value of the type, and NaN among the distances.\n"
      "\nExample:\n"
      "  pointsweep neighbors scan.ply graph.npy -k 16 --distances distances.npy");
  verb.callback([command] { neighbors(*command); });
}

}  // namespace pointsweep
