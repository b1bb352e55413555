// SPDX-License-Identifier: MIT
/// `pointsweep info FILE...`: what is in a point file, found by reading all of it.
#include "cli/commands.h"
#include "cli/common_options.h"
#include "cli/file_summary.h"
#include "cli/interrupt.h"
#include "cli/progress.h"
#include "pointsweep/error.h"

namespace pointsweep {
namespace {

struct InfoOptions {
  CommonOptions common;
  std::vector<std::filesystem::path> files;
};

void info(const InfoOptions& options) {
  std::uint64_t points = 0;
  Box bounds;
  ProgressDisplay progress(options.common);
  for (const auto& file : options.files) {
    const std::unique_ptr<Reader> reader = open_reader(file);
    const FileSummary summary = summarize(*reader, [&](std::uint64_t done, std::uint64_t total) {
      stop_if_interrupted();
      progress.report("info", done, total);
    });
    for (const std::string& warning : reader->info().warnings)
      progress.say(fmt::format("{}: {}", file.string(), warning));
    fmt::print("{}", to_text(reader->info(), summary));
    points += reader->info().count;
    bounds.include(summary.bounds);
  }
  if (options.files.size() > 1) fmt::print("all {} files\n{}", options.files.size(), to_text(points, bounds));
}

}  // namespace

void add_info_command(CLI::App& app) {
  CLI::App& verb = *app.add_subcommand("info", "Say what is in point files: format, count, bounds, attributes, order");
  auto options = std::make_shared<InfoOptions>();
  verb.add_option("FILE", options->files, "Point files")->required()->type_name("");
  add_progress_options(verb, options->common);
  verb.footer(
      "The files are read to their end, so that bounds and order are those of the points, not of a header.\n"
      "\nExample:\n"
      "  pointsweep info scan.ply tile_*.las");
  verb.callback([options] { info(*options); });
}

}  // namespace pointsweep
