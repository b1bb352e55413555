// SPDX-License-Identifier: MIT
/// The verbs that divide an output:
/// - `pointsweep tile IN... OUT/ --size S` cuts a cloud into square tiles;
/// - `pointsweep split IN... OUT/ --by A` writes a file for each value of an attribute, with --parts N for each of N
///   random parts.
#include <memory>

#include "cli/verbs/cloud_run.h"
#include "cli/verbs/commands.h"
#include "pointsweep/error.h"

namespace pointsweep {
namespace {

struct SplitCommand {
  PipelineRun run;
  std::vector<OptionText> parts;  ///< options of the stage `parts`
};

constexpr const char* kOutput =
    "folder for the files that are made, or their names with a * in it, such as 'out/north_*.laz'";

}  // namespace

void declare_tile_verb(CLI::App& verb) {
  auto run = std::make_shared<PipelineRun>();
  add_inputs_and_output(verb, run->paths, kOutput);
  add_run_option(verb, run->common, "tile", "Length of the edge of a tile, in the unit of x and y (required)",
                 "--size");
  add_run_option(verb, run->common, "tile_origin", nullptr, "--origin");
  add_run_option(verb, run->common, "tile_buffer", nullptr, "--buffer");
  add_file_options(verb, *run);
  verb.footer(
      "The inputs are one cloud, of which each point comes into one tile. Its file is called X_Y after its lower "
      "corner, and the tile holds X <= x < X + size and Y <= y < Y + size of the coordinates in that file. Same as "
      "'pointsweep run' with --tile, which any command can take that runs a pipeline.\n"
      "A buffer is for other programs: pointsweep itself needs none, since it finds neighbours in other tiles. "
      "where(buffer == 0) leaves it out again.\n"
      "\nExample: flight lines as tiles of 500 m, in LAZ:\n"
      "  pointsweep tile lines/ tiles/ --size 500 --output-format laz");
  verb.callback([run] {
    if (!run->common.division.tile) throw UsageError("tile: give the length of the edge of a tile, --size LENGTH.");
    run_stages({}, *run);
  });
}

void declare_split_verb(CLI::App& verb) {
  auto command = std::make_shared<SplitCommand>();
  PipelineRun& run = command->run;
  add_inputs_and_output(verb, run.paths, kOutput);
  add_run_option(verb, run.common, "split", "A file for each value of this attribute, e.g. classification", "--by");
  for (const OptionDeclaration& option : declaration_of("parts")->options)
    add_stage_option(verb, option.name == "number" ? "--parts" : "--" + option.name, option, command->parts);
  add_file_options(verb, run);
  verb.footer(
      "The inputs are one cloud, of which each point comes into one file: classification_2.laz has the points of class "
      "2. --parts divides them at random, as the operator parts does, into part_0, part_1 and so on, which have the "
      "attribute part.\n"
      "\nExamples: a file for each flight line; ten parts, some to train with and some to test:\n"
      "  pointsweep split scan.laz lines/ --by point_source_id\n"
      "  pointsweep split scan.laz parts/ --parts 10");
  verb.callback([command] {
    PipelineRun& given = command->run;
    const bool has_parts = gives(command->parts, "number");
    if (has_parts == !given.common.division.split.empty())
      throw UsageError("split: give one of --by ATTRIBUTE and --parts NUMBER.");
    if (!has_parts && !command->parts.empty()) throw UsageError("--seed: belongs to --parts; leave it out.");
    if (!has_parts) return run_stages({}, given);
    given.common.division.split = "part";
    run_stages({{"parts", command->parts, "split"}}, given);
  });
}

}  // namespace pointsweep
