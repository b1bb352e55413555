// SPDX-License-Identifier: MIT
/// The verb `pointsweep sort IN... OUT`, which writes the points in order along an axis.
#include "cli/verbs/cloud_run.h"
#include "cli/verbs/commands.h"

namespace pointsweep {
namespace {

struct SortCommand {
  CommonOptions common;
  InputsAndOutput paths;
};

constexpr const char* kOneOrder = "sort puts the points of all inputs in one order";

void sort_points(const SortCommand& command) {
  const std::vector<std::string>& keep = command.common.keep;
  run_over_cloud(command.paths, command.common,
                 {.run =
                      [&](Cloud& cloud, const ResolvedFiles& files, const RunOptions& options) {
                        require_one_output(files, kOneOrder);
                        return sort(cloud, files.output, options, keep);
                      },
                  .plan =
                      [&](Cloud& cloud, const ResolvedFiles& files, const RunOptions& options) {
                        require_one_output(files, kOneOrder);
                        return sort_plan_text(cloud, files.output, options, keep);
                      }});
}

}  // namespace

void declare_sort_verb(CLI::App& verb) {
  auto command = std::make_shared<SortCommand>();
  add_inputs_and_output(verb, command->paths, "with the attributes of the input, unchanged");
  add_keep_option(verb, command->common.keep,
                  "Attributes to write, e.g. intensity,classification; x, y and z always are (default: all)");
  add_named_options(verb, command->common,
                    {"scale", "offset", "point_format", "las_version", "decimals", "provenance", "no_provenance"});
  add_stated_crs_options(verb, command->common);
  add_run_options(verb, command->common);
  verb.footer(
      "Equal coordinates are ordered by x, y, z, then by input row. Points with NaN or infinite coordinates come "
      "last.\n"
      "\nExample:\n"
      "  pointsweep sort tile_1.las tile_2.las sorted.las --axis x --memory 1G");
  verb.callback([command] { sort_points(*command); });
}

}  // namespace pointsweep
