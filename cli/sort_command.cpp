// SPDX-License-Identifier: MIT
/// `pointsweep sort IN... OUT`: the ordered stream as a normal file.
#include "cli/cloud_run.h"
#include "cli/commands.h"

namespace pointsweep {
namespace {

struct SortCommand {
  CommonOptions common;
  InputsAndOutput paths;
};

}  // namespace

void add_sort_command(CLI::App& app) {
  CLI::App& verb = *app.add_subcommand("sort", "Write the points in ascending order along an axis");
  auto command = std::make_shared<SortCommand>();
  add_inputs_and_output(verb, command->paths, "the file to write, attributes unchanged");
  add_output_option(verb, command->paths.named_output);
  add_run_options(verb, command->common);
  verb.footer(
      "Equal coordinates are ordered by x, y, z, then input row; points with NaN or infinite coordinates come last.\n"
      "\nExample:\n"
      "  pointsweep sort tile_*.las sorted.las --axis x --memory 1G");
  verb.callback([command] {
    run_over_cloud(command->paths, command->common, [&](Cloud& cloud, const RunOptions& options) {
      return sort(cloud, command->paths.output(), options);
    });
  });
}

}  // namespace pointsweep
