// SPDX-License-Identifier: MIT
#include "cli/cloud_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "cli/command_line.h"
#include "cli/help.h"
#include "cli/interrupt.h"
#include "cli/progress.h"
#include "cli/quantities.h"
#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/formats/extension.h"
#include "pointsweep/formats/files/output_file.h"
#include "pointsweep/formats/files/same_file.h"
#include "pointsweep/formats/files/standard_streams.h"
#include "pointsweep/formats/registry.h"
#include "pointsweep/report/pictured_attribute.h"
#include "pointsweep/report/run_report.h"

namespace pointsweep {
namespace {

EngineOptions run_options(const CommonOptions& options) {
  EngineOptions run;
  run.resources.memory_bytes = options.memory;
  run.resources.threads = static_cast<unsigned>(options.threads);
  run.resources.temp_folder = options.temp_dir;
  run.axis = options.axis;
  run.order = options.order;
  run.engine = options.engine;
  run.overwrite = options.force;
  run.moved_positions = options.moved_positions.value_or(run.moved_positions);
  run.count_distances = !options.report.empty();
  run.half_way_states = options.half_way;
  run.resume_folder = options.resume;
  run.checkpoint_seconds = options.checkpoint_seconds;
  run.nonfinite = options.nonfinite;
  run.replace = options.replace;
  run.prefix = options.prefix;
  run.provenance = options.provenance;
  run.input_paths = options.provenance_paths;
  return run;
}

InputCloud open_inputs(InputsAndOutput paths, const CommonOptions& options) {
  for (const auto& path : {options.stats, options.report, options.half_way}) paths.other_outputs.push_back(path);
  require_named_files(paths);
  take_standard_input(paths.inputs(), options);
  return InputCloud(paths.inputs(), cloud_options(options));
}

/// The name of the report, refused if it is not that of a page.
const std::filesystem::path& page_name(const std::filesystem::path& file) {
  if (extension_of(file) != ".html")
    fail_usage("--report: {}: the report is a page; give a name that ends with .html.", file.string());
  return file;
}

void complete(OutputFile& file, const std::string& text) {
  file.append(std::as_bytes(std::span(text)));
  file.commit();
}

/// The result, read again; none where the output is no point file or has no
/// point to show.
std::optional<Rendering> picture_of(const std::filesystem::path& output, const Schema& input,
                                    const Statistics& statistics, ProgressDisplay& display) {
  if (is_array_name(output) || is_standard_stream(output) || statistics.points_written == 0 ||
      statistics.nonfinite - statistics.dropped == statistics.points)
    return std::nullopt;
  InputCloud cloud({output});
  RenderOptions options;
  options.width = 900;
  options.height = 640;
  std::vector<std::string> operators;
  for (const auto& [name, seconds] : statistics.operator_seconds) operators.push_back(name);
  options.color = pictured_attribute(operators, input, cloud.schema());
  options.progress = [&display](const char* phase, std::uint64_t done, std::uint64_t total) {
    stop_if_cancelled();
    display.report(phase, done, total);
  };
  return render(cloud, options);
}

RunSummary summary_of(const InputsAndOutput& paths, const Schema& input, const Statistics& statistics,
                      ProgressDisplay& display) {
  RunSummary summary;
  summary.title = paths.output().filename().string();
  summary.output = paths.output().string();
  summary.command = command_line();
  summary.version = kept_version();
  summary.statistics = statistics;
  summary.picture = picture_of(paths.output(), input, statistics, display);
  for (const auto& path : paths.inputs()) summary.inputs += (summary.inputs.empty() ? "" : ", ") + path.string();
  return summary;
}

/// What degenerate results are, and where their rows are listed.
std::string about_degenerate(const Statistics& s, const std::filesystem::path& stats) {
  return fmt::format(
      "{} undefined because the points have too few neighbours, or neighbours that all lie on a line or in one place: "
      "there normals, curvatures and splats are 0 and fair leaves the point in place; {} of the points",
      s.degenerate == 1 ? "one result is" : fmt::format("{} results are", s.degenerate),
      stats.empty() ? "--stats FILE lists the rows"
                    : fmt::format("degenerate_rows in {} lists the rows", stats.string()));
}

/// "wrote out.ply: 20000000 points in 9.1 s, 2.20M/s, at most 412M of memory"
std::string conclusion(const std::filesystem::path& output, const Statistics& s, const std::filesystem::path& stats) {
  std::string text = fmt::format("wrote {}: {} points",
                                 is_standard_stream(output) ? "standard output" : output.string(), s.points_written);
  if (s.points_written < s.points) text += fmt::format(" of {}", s.points);
  text += fmt::format(" in {:.1f} s", s.total_seconds);
  if (s.total_seconds > 0) text += fmt::format(", {}/s", count_text(static_cast<double>(s.points) / s.total_seconds));
  text += fmt::format(", at most {} of memory", size_text(s.peak_rss_bytes));
  if (s.degenerate > 0) text += "; " + about_degenerate(s, stats);
  const std::uint64_t kept = s.nonfinite - s.dropped;
  if (kept > 0) text += fmt::format("; {} with coordinates that are not finite", kept);
  return text;
}

/// Shows what a run tells. Signals cancel it.
class RunDisplay final : public Observer {
 public:
  explicit RunDisplay(ProgressDisplay& display) : display_(display) {}
  void on_progress(const Progress& p) override { display_.report(p.phase, p.done, p.total); }
  void on_warning(const std::string& sentence) override { display_.say(sentence); }
  const CancellationToken& token() const noexcept override { return interrupt_token(); }

 private:
  ProgressDisplay& display_;
};

}  // namespace

void add_inputs_and_output(CLI::App& verb, InputsAndOutput& paths, const char* output_meaning) {
  verb.add_option(
          kInputsAndOutput, paths.files,
          fmt::format("Input files (merged), then output {}; - is standard input or output (PLY)", output_meaning))
      ->type_name("");
}

void add_output_option(CLI::App& verb, std::filesystem::path& output) {
  verb.add_option("-o,--output", output, "Output file; all other files are then inputs (default: the last file)")
      ->type_name("FILE");
}

void take_standard_input(const std::vector<std::filesystem::path>& inputs, const CommonOptions& options) {
  const auto count = std::ranges::count_if(inputs, is_standard_stream);
  if (count > 1) fail_usage("-: standard input can be one of the inputs only once.");
  if (count == 0) return;
  if (!options.resume.empty())
    fail_usage("--resume: standard input cannot be read again by another process; save it to a file first.");
  take_standard_input(options.temp_dir);
}

void require_named_files(const InputsAndOutput& paths) {
  if (paths.inputs_named() == 0)
    fail_usage("IN... OUT: name at least one input file, then the output file (or name it with -o FILE).");
  std::error_code error;
  const bool last_exists = !is_standard_stream(paths.output()) &&
                           std::filesystem::exists(std::filesystem::symlink_status(paths.output(), error));
  if (paths.named_output.empty() && paths.inputs_named() > 1 && last_exists)
    fail_usage(
        "{}: exists, and as the last of {} files it may be an input; name the output with -o FILE, before or after the "
        "inputs.",
        paths.output().string(), paths.files.size());
  std::vector<std::filesystem::path> read = paths.inputs(), written = {paths.output()};
  read.insert(read.end(), paths.other_inputs.begin(), paths.other_inputs.end());
  written.insert(written.end(), paths.other_outputs.begin(), paths.other_outputs.end());
  require_separate_files(read, written);
}

void add_run_options(CLI::App& verb, CommonOptions& options) {
  add_dry_run_option(verb, options);
  add_stream_options(verb, options);
  add_nonfinite_option(verb, options);
  add_thread_option(verb, options);
  add_crs_option(verb, options);
  add_format_option(verb, options.format);
  add_force_option(verb, options);
  add_progress_options(verb, options);
}

void run_over_cloud(const InputsAndOutput& paths, const CommonOptions& options,
                    const std::function<Statistics(InputCloud& cloud, const EngineOptions& options)>& work) {
  InputCloud cloud = open_inputs(paths, options);
  std::optional<OutputFile> stats;  // made first: a place that cannot be written is known before the work, not after
  if (!options.stats.empty()) stats.emplace(options.stats, options.force);
  std::optional<OutputFile> report;
  if (!options.report.empty()) report.emplace(page_name(options.report), options.force);
  ProgressDisplay display(options);
  EngineOptions run = run_options(options);
  RunDisplay watching(display);
  run.observer = &watching;
  const Statistics statistics = work(cloud, run);
  if (stats) complete(*stats, to_json(statistics) + "\n");
  if (report) complete(*report, report_of(summary_of(paths, cloud.schema(), statistics, display)));
  display.say(conclusion(paths.output(), statistics, options.stats));
}

void look_at_cloud(const InputsAndOutput& paths, const CommonOptions& options,
                   const std::function<void(InputCloud& cloud, const EngineOptions& options)>& work) {
  InputCloud cloud = open_inputs(paths, options);
  work(cloud, run_options(options));
}

}  // namespace pointsweep
