// SPDX-License-Identifier: MIT
/// `pointsweep verify IN... OUT`: an independent check of the output of a run.
#include <fstream>
#include <string>
#include <string_view>

#include "cli/console/console.h"
#include "cli/verbs/cloud_run.h"
#include "cli/verbs/commands.h"
#include "cli/verbs/progress.h"
#include "pointsweep/verify.h"

namespace pointsweep {
namespace {

struct VerifyCommand {
  CommonOptions common;
  InputsAndOutput paths;
  std::vector<OptionText> neighborhood;
  VerifyOptions check;
  Checksums checksums = Checksums::leave_out;
};

std::vector<std::uint64_t> rows_named_in(const std::string& path) {
  std::ifstream file(path);
  if (!file) refuse("--rows: cannot open {}.", path);
  std::vector<std::uint64_t> rows;
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  for (std::string word; file >> word;) {
    if (rows.empty() && word.starts_with(kByteOrderMark)) word.erase(0, kByteOrderMark.size());
    rows.push_back(parse_count("--rows", word));
  }
  return rows;
}

VerifyOptions check_options(const VerifyCommand& command, ProgressDisplay& display) {
  VerifyOptions options = command.check;
  make_neighborhood(read_options(neighborhood_declaration().options, {"knn", command.neighborhood, "verify"}));
  for (const OptionText& given : command.neighborhood) options.neighborhood.push_back({given.name, given.value});
  options.axis = command.common.axis;
  options.division = command.common.division;
  options.prefix = command.common.prefix;
  options.decimals = command.common.layout.decimals;
  options.positions = command.common.positions;
  options.nonfinite = command.common.nonfinite;
  options.recursive = command.paths.recursive;
  options.cloud = cloud_options(command.common);
  if (command.common.resources.memory_bytes != 0) options.memory_bytes = command.common.resources.memory_bytes;
  options.progress = reporting_to(display);
  return options;
}

void run_check(const VerifyCommand& command) {
  take_standard_input(command.paths.files, command.common);
  if (command.paths.files.empty()) refuse("IN... OUT: name what was read, and last what was written.");
  ProgressDisplay display(command.common);
  const Verdict verdict = verify(command.paths.inputs(), command.paths.output(), check_options(command, display));
  if (!command.common.quiet) print(to_text(verdict, command.checksums));
  if (!verdict.same()) throw Error(fmt::format("{}: {}.", conclusion(verdict), verdict.differences.front()));
  if (!verdict.is_complete()) throw NotChecked(fmt::format("{}: {}.", verdict.output, conclusion(verdict)));
}

void add_check_options(CLI::App& verb, VerifyCommand& command) {
  verb.add_option_function<std::string>(
          "--sample", [&command](const std::string& text) { command.check.sample = parse_count("--sample", text); },
          "Number of points whose computed attributes are recomputed by brute force (default: 10000)")
      ->type_name("N");
  verb.add_option("--seed", command.check.seed, "Seed of the random choice of these points (default: 0)")
      ->type_name("S");
  verb.add_option_function<std::string>(
          "--rows", [&command](const std::string& path) { command.check.rows = rows_named_in(path); },
          "Additional points to recompute: row numbers from 0, separated by spaces or newlines")
      ->type_name("FILE");
  verb.add_option_function<std::string>(
          "--order",
          [&command](const std::string& name) {
            run_option("order").set(command.common, name, "--order");
            command.check.order = command.common.order;
          },
          "Order of the rows of the output (default: detected)")
      ->type_name("input|sweep");
  verb.add_flag_callback(
      "--checksums", [&command] { command.checksums = Checksums::show; },
      "Also show a checksum of the values of each attribute, which does not depend on the order of rows");
  add_named_options(verb, command.common, {"axis", "nonfinite"});
  for (const char* name : {"prefix", "decimals", "positions", "tile", "tile_origin", "tile_buffer", "split"}) {
    const std::string meaning =
        fmt::format("The {} of the run (default: as recorded in the output)", run_option(name).flag);
    add_run_option(verb, command.common, name, meaning.c_str());
  }
}

}  // namespace

void declare_verify_verb(CLI::App& verb) {
  auto command = std::make_shared<VerifyCommand>();
  add_files(verb, command->paths, "file or folder that a run has written from them");
  add_neighborhood_options(verb, "", command->neighborhood);
  verb.add_option("--pipeline", command->check.pipeline,
                  "The pipeline of the run (default: the record in the output, or guessed from its attributes)")
      ->type_name("TEXT|FILE");
  add_keep_option(verb, command->check.keep,
                  "The --keep of the run (default: as recorded in the output, or all attributes)");
  add_check_options(verb, *command);
  add_run_option(verb, command->common, "memory",
                 "Memory for the neighbours of the sample; a larger sample is checked in several passes (default: 1G)");
  add_crs_option(verb, command->common);
  add_format_option(verb, command->common.format);
  add_progress_options(verb, command->common);
  verb.footer(
      "Compares every point and attribute of the input with the output. For a sample of points, finds the neighbours "
      "by\n"
      "brute force and recomputes the computed attributes by formulas that the run does not use. An output with a\n"
      "record of its run (see info) needs no options, and no inputs if these are in its folder or in the current one.\n"
      "Otherwise give the options of the run; --pipeline if normals were oriented, points moved or attributes "
      "replaced.\n"
      "Without computed attributes, two files are compared, whatever their formats and orders.\n"
      "Exit status: 0 if all was checked and is right, 1 if the output differs, 3 if not all could be checked and the\n"
      "rest is right.\n"
      "\nExample:\n"
      "  pointsweep verify normals.ply\n"
      "  pointsweep verify scan.ply normals.ply -k 12\n"
      "  pointsweep verify scan.ply out.las --pipeline 'knn(k=12) | normals(orient=up)' --sample 1000");
  verb.callback([command] { run_check(*command); });
}

}  // namespace pointsweep
