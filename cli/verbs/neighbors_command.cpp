// SPDX-License-Identifier: MIT
/// `pointsweep neighbors IN... OUT.npy`: the exact k-nearest-neighbour graph as a NumPy array.
#include <fmt/format.h>

#include <algorithm>

#include "cli/console/console.h"
#include "cli/text/help.h"
#include "cli/verbs/cloud_run.h"
#include "cli/verbs/commands.h"
#include "pointsweep/operators.h"
#include "pointsweep/program/formats.h"

namespace pointsweep {
namespace {

/// Returns the number of neighbours that the verb finds without -k.
std::string default_k() { return text_of_value(neighbors_declaration().options.front().preset); }

struct NeighborsCommand {
  CommonOptions common;
  InputsAndOutput paths;
  std::vector<OptionText> neighborhood;
  std::filesystem::path distances;
};

using Arrays = std::vector<std::pair<std::string, std::filesystem::path>>;

void require_npy(const std::filesystem::path& path) {
  if (!is_array_name(path)) refuse("{}: the graph is a NumPy array; name a {} file.", path.string(), array_extension());
}

/// Returns the arrays to write. OUT gets `neighbors`, or `distances` if --keep names only these; --distances gets
/// distances.
Arrays arrays_of(const NeighborsCommand& command) {
  const std::vector<std::string>& keep = command.common.keep;
  const auto kept = [&](const char* name) { return keep.empty() || std::ranges::find(keep, name) != keep.end(); };
  for (const std::string& name : keep)
    if (name != "neighbors" && name != "distances")
      refuse("--keep: '{}' is not neighbors or distances, the arrays that this verb makes.", name);
  if (!kept("neighbors") && !command.distances.empty())
    refuse("--keep distances writes the distances to {}; leave out --distances.", command.paths.output().string());
  if (!kept("neighbors")) return {{"distances", command.paths.output()}};
  if (!keep.empty() && kept("distances") && command.distances.empty())
    refuse("--keep: distances need a file of their own; name it with --distances.");
  if (!kept("distances") && !command.distances.empty())
    refuse("--keep: without distances nothing goes to --distances; leave one of them out.");
  Arrays arrays = {{"neighbors", command.paths.output()}};
  if (!command.distances.empty()) arrays.emplace_back("distances", command.distances);
  return arrays;
}

/// Returns the neighbourhood of the request, always with a limit k, since the array has k columns.
Neighborhood neighborhood_of(const NeighborsCommand& command) {
  StageText knn{neighborhood_declaration().name, command.neighborhood, "neighbors"};
  if (!gives(knn.options, "k")) knn.options.push_back({"k", default_k(), "neighbors"});
  return make_neighborhood(read_options(neighborhood_declaration().options, knn));
}

Chain chain_of(const NeighborsCommand& command, const Arrays& arrays, std::uint64_t points) {
  const Neighborhood neighborhood = neighborhood_of(command);
  const bool distances = arrays.back().first == "distances";
  Chain chain{neighborhood, {operators::neighbors(neighborhood.k, points, distances)}};
  if (arrays.front().first == "distances") chain.keep = {"distances"};
  return chain;
}

void neighbors(const NeighborsCommand& command) {
  InputsAndOutput paths = command.paths;
  paths.other_outputs.push_back(command.distances);
  resolve(paths, command.common.format);  // refuses an output that is an input
  require_npy(paths.output());
  neighborhood_of(command);  // wrong options are refused before files are opened
  if (!command.distances.empty()) require_npy(command.distances);
  run_over_cloud(paths, command.common,
                 {.run =
                      [&](Cloud& cloud, const ResolvedFiles&, const RunOptions& options) {
                        const Outputs outputs{.points = {}, .arrays = arrays_of(command), .writer = {}};
                        return run(cloud, chain_of(command, outputs.arrays, cloud.count()), outputs, options);
                      },
                  .plan =
                      [&](Cloud& cloud, const ResolvedFiles&, const RunOptions& options) {
                        return plan_text(cloud, chain_of(command, arrays_of(command), cloud.count()), {}, options);
                      }});
}

}  // namespace

void declare_neighbors_verb(CLI::App& verb) {
  auto command = std::make_shared<NeighborsCommand>();
  add_inputs_and_output(verb, command->paths, ".npy array: n rows of k input rows, nearest first");
  add_neighborhood_options(verb, default_k(), command->neighborhood);
  verb.get_option("-k")->description(
      fmt::format("Number of neighbours, excluding the point, and of columns (default: {})", default_k()));
  verb.add_option("--distances", command->distances, "Write the distances, float64, to this .npy file")
      ->type_name("FILE")
      ->group(kOutputGroup);
  add_keep_option(verb, command->common.keep,
                  "Arrays to write: neighbors, distances or both; distances alone go to OUT (default: neighbors, and "
                  "distances with --distances)");
  add_run_option(verb, command->common, "engine");
  add_run_options(verb, command->common);
  verb.footer(
      "Row numbers count through the inputs in the order given, from 0. Equal distances are ordered by x, y, z, then "
      "by row. The array has k columns, also with --radius. Where a point has fewer than k neighbours, the rest of its "
      "row is the largest value of the type, and NaN in the distances.\n"
      "\nExample:\n"
      "  pointsweep neighbors scan.ply graph.npy -k 16 --distances distances.npy");
  verb.callback([command] { neighbors(*command); });
}

}  // namespace pointsweep
