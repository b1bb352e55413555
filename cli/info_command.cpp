// SPDX-License-Identifier: MIT
/// `pointsweep info FILE...`: what is in a point file, found by reading all of it.
#include <nlohmann/json.hpp>

#include "cli/cloud_run.h"
#include "cli/commands.h"
#include "cli/common_options.h"
#include "cli/file_summary.h"
#include "cli/progress.h"
#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

struct InfoOptions {
  CommonOptions common;
  std::vector<std::filesystem::path> files;
  bool json = false;
  Spacing spacing = Spacing::measure;
};

/// What is said of the files, one after the other, and of all of them.
class InfoReport {
 public:
  explicit InfoReport(bool as_json) : as_json_(as_json) {}

  void add(const FileInfo& info, const FileSummary& summary) {
    points_ += info.count;
    bounds_.include(summary.bounds);
    if (as_json_)
      files_.push_back(to_json(info, summary));
    else
      fmt::print("{}", to_text(info, summary));
  }
  void add_failure(const std::filesystem::path& file, const std::string& sentence) {
    ++failures_;
    if (as_json_) files_.push_back({{"path", file.string()}, {"error", sentence}});
  }
  void finish(std::size_t files) const {
    if (as_json_) {
      const nlohmann::ordered_json all = {
          {"files", files}, {"unreadable", failures_}, {"points", points_}, {"bounds", to_json(bounds_)}};
      const nlohmann::ordered_json report = {{"files", files_}, {"all", all}};
      fmt::print("{}\n", report.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    } else if (files > 1) {
      const std::string which =
          failures_ == 0 ? fmt::format("all {} files", files) : fmt::format("{} of {} files", files - failures_, files);
      fmt::print("{}\n{}", which, to_text(points_, bounds_));
    }
  }
  std::size_t failures() const { return failures_; }

 private:
  bool as_json_;
  nlohmann::ordered_json files_ = nlohmann::ordered_json::array();
  std::uint64_t points_ = 0;
  Box bounds_;
  std::size_t failures_ = 0;
};

void look_at_file(const std::filesystem::path& file, const InfoOptions& options, InfoReport& report,
                  ProgressDisplay& progress) {
  const std::unique_ptr<Reader> reader = open_reader(file, options.common.format);
  const FileSummary summary = summarize(*reader, options.spacing, [&](std::uint64_t done, std::uint64_t total) {
    stop_if_cancelled();
    progress.report("info", done, total);
  });
  for (const std::string& warning : reader->info().warnings)
    progress.say(warning.starts_with(file.string()) ? warning : fmt::format("{}: {}", file.string(), warning));
  report.add(reader->info(), summary);
}

/// Errors reach people also with --quiet.
void complain(const std::string& sentence, const CommonOptions& options, ProgressDisplay& progress) {
  if (options.quiet)
    fmt::print(stderr, "pointsweep: {}\n", sentence);
  else
    progress.say(sentence);
}

void info(const InfoOptions& options) {
  InfoReport report(options.json);
  ProgressDisplay progress(options.common);
  take_standard_input(options.files, options.common);
  for (const auto& file : options.files) {
    try {
      look_at_file(file, options, report, progress);
    } catch (const Cancelled&) {
      throw;
    } catch (const Error& error) {
      complain(error.what(), options.common, progress);
      report.add_failure(file, error.what());
    }
  }
  report.finish(options.files.size());
  if (report.failures() > 0) fail("{} of {} files could not be read.", report.failures(), options.files.size());
}

}  // namespace

void add_info_command(CLI::App& app) {
  CLI::App& verb = *app.add_subcommand("info", "Say what is in point files: format, bounds, density, attributes, ...");
  auto options = std::make_shared<InfoOptions>();
  verb.add_option("FILE", options->files, "Point files")->required()->type_name("");
  verb.add_flag("--json", options->json, "Write one JSON object; docs/info.md lists its keys");
  verb.add_flag_callback(
      "--no-spacing", [options] { options->spacing = Spacing::skip; },
      "Read files once instead of twice, without the distances between points");
  add_format_option(verb, options->common.format);
  add_progress_options(verb, options->common);
  verb.footer(
      "The files are read to their end, so that bounds, counts and ranges are those of the points, not of a header.\n"
      "A file that cannot be read is reported; the others are still read, and the exit status is 1.\n"
      "\nExample:\n"
      "  pointsweep info scan.ply tile_*.las");
  verb.callback([options] { info(*options); });
}

}  // namespace pointsweep
