// SPDX-License-Identifier: MIT
#include "cli/verbs/cloud_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <set>

#include "cli/console/console.h"
#include "cli/console/interrupt.h"
#include "cli/console/program.h"
#include "cli/verbs/progress.h"
#include "pointsweep/program/formats.h"
#include "pointsweep/program/report.h"
#include "pointsweep/program/standard_streams.h"
#include "pointsweep/program/whole_file.h"

namespace pointsweep {
namespace {

RunOptions run_options(const CommonOptions& options) {
  RunOptions run = options;
  run.count_distances = !options.report.empty();
  return run;
}

/// Returns the files that a command names, and makes standard input readable if it is one of them.
ResolvedFiles files_of(InputsAndOutput named, const CommonOptions& options) {
  for (const auto& path : {options.stats, options.report, options.half_way_states}) named.other_outputs.push_back(path);
  named.divides = options.division.divides();
  named.resumes = !options.resume_folder.empty();
  ResolvedFiles files = resolve(named, options.format);
  take_standard_input(files.inputs, options);
  return files;
}

/// Returns the name of the report. Throws UsageError unless the name ends with .html.
const std::filesystem::path& page_name(const std::filesystem::path& file) {
  if (extension_of(file) != ".html")
    refuse("--report: {}: the report is a page; give a name that ends with .html.", file.string());
  return file;
}

/// Returns whether the run divides its output among files, whose names it chooses.
bool is_divided(const ResolvedFiles& files) {
  return files.tiles.empty() && files.output.filename().string().find('*') != std::string::npos;
}

/// Time limit for drawing the picture of the page about a run: this share of the time of the run, at least
/// kPageSeconds.
constexpr double kPageShare = 0.1, kPageSeconds = 0.5;

/// Reads the output of the run. Adds a picture of it and summaries of its computed attributes to `summary`. Does
/// nothing if the output is divided among files, is standard output or an array, or has no finite point.
void add_result(const ResolvedFiles& files, const Cloud& input, ProgressDisplay& display, RunSummary& summary) {
  const Statistics& statistics = summary.statistics;
  if (is_divided(files) || is_array_name(files.output) || is_standard_output(files.output) ||
      statistics.points_written == 0 || statistics.nonfinite - statistics.dropped == statistics.points)
    return;
  const auto start = std::chrono::steady_clock::now();
  Cloud cloud(files.tiles.empty() ? std::vector{files.output} : files.tiles, {.ignore_crs = true});
  RenderOptions options;
  options.width = 900;
  options.height = 640;
  options.length_unit = summary.unit;
  options.seconds = std::max(kPageSeconds, kPageShare * statistics.total_seconds);
  std::vector<std::string> operators;
  for (const auto& [name, seconds] : statistics.operator_seconds) operators.push_back(name);
  options.color = pictured_attribute(operators, input.schema(), cloud.schema());
  options.progress = reporting_to(display);
  summary.picture = render(cloud, options);
  summary.made = value_summaries(cloud.schema(), summary.picture->sample,
                                 made_numbers(operators, input.schema(), cloud.schema()), summary.unit);
  summary.drawing_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

RunSummary summary_of(const ResolvedFiles& files, const Cloud& input, const Statistics& statistics,
                      ProgressDisplay& display) {
  RunSummary summary;
  summary.title = (files.tiles.empty() ? files.output : (files.output / "").parent_path()).filename().string();
  summary.output = files.output.string();
  summary.command = command_line();
  summary.version = version_number();
  summary.statistics = statistics;
  if (input.crs()) {
    summary.crs = short_text(*input.crs());
    summary.unit = input.crs()->kind == CrsKind::geographic ? "degrees" : length_unit_of(*input.crs());
  }
  add_result(files, input, display, summary);
  for (const auto& path : files.inputs) summary.inputs += (summary.inputs.empty() ? "" : ", ") + path.string();
  return summary;
}

/// Returns a sentence for each stage that marked points as degenerate; equal sentences only once.
std::set<std::string> about_degenerate(const Statistics& s, const std::filesystem::path& stats) {
  const std::string rows = stats.empty() ? "--stats FILE lists the rows"
                                         : fmt::format("degenerate_rows in {} lists the rows", stats.string());
  std::set<std::string> sentences;
  for (const DegenerateResults& results : s.degenerate_results) {
    const OperatorDeclaration* const declaration = declaration_of(results.stage);
    if (results.count == 0 || declaration == nullptr) continue;
    sentences.insert(fmt::format("{}: {} points {} ({}).", results.stage, grouped_text(results.count),
                                 declaration->degenerate, rows));
  }
  return sentences;
}

/// Returns a sentence like "wrote out.ply: 20000000 points in 9.1 s, 2.20M/s, at most 412M of memory".
std::string conclusion(const ResolvedFiles& files, const Statistics& s) {
  const std::filesystem::path output = is_divided(files) ? files.output.parent_path() / "" : files.output;
  std::string text = fmt::format("wrote {}: ", is_standard_output(output) ? "standard output" : output.string());
  if (!files.tiles.empty() || is_divided(files))
    text += s.files_written == 1 ? "1 file, " : fmt::format("{} files, ", s.files_written);
  text += fmt::format("{} points", s.points_written);
  if (s.points_written < s.points) text += fmt::format(" of {}", s.points);
  text += fmt::format(" in {:.1f} s", s.total_seconds);
  if (s.total_seconds > 0) text += fmt::format(", {}/s", count_text(static_cast<double>(s.points) / s.total_seconds));
  text += fmt::format(", at most {} of memory", size_text(s.peak_rss_bytes));
  const std::uint64_t kept = s.nonfinite - s.dropped;
  if (kept > 0) text += fmt::format("; {} with coordinates that are not finite", kept);
  return text;
}

/// Shows the progress and messages of a run, which the signals of interrupt_token() cancel.
class RunDisplay final : public Observer {
 public:
  explicit RunDisplay(ProgressDisplay& display) : display_(display) {}
  void on_progress(const Progress& p) override { display_.report(p.phase, p.done, p.total); }
  void on_warning(const std::string& sentence) override { display_.say(Severity::warning, sentence); }
  void on_note(const std::string& sentence) override { display_.say(Severity::note, sentence); }
  const CancellationToken& token() const noexcept override { return interrupt_token(); }

 private:
  ProgressDisplay& display_;
};

}  // namespace

void take_standard_input(const std::vector<std::filesystem::path>& inputs, const CommonOptions& options) {
  const auto count = std::ranges::count_if(inputs, is_standard_stream);
  if (count > 1) refuse("-: standard input can be one of the inputs only once.");
  if (count == 0) return;
  if (!options.resume_folder.empty())
    refuse("--resume: standard input cannot be read again by another process; save it to a file first.");
  take_standard_input(options.resources.temp_folder);
}

void add_run_options(CLI::App& verb, CommonOptions& options) {
  add_dry_run_option(verb, options);
  add_stream_options(verb, options);
  add_named_options(verb, options, {"nonfinite", "threads"});
  add_crs_option(verb, options);
  add_format_option(verb, options.format);
  add_run_option(verb, options, "overwrite");
  add_progress_options(verb, options);
}

void run_over_cloud(const InputsAndOutput& paths, const CommonOptions& options, const CloudWork& work) {
  const ResolvedFiles files = files_of(paths, options);
  Cloud cloud(files.inputs, cloud_options(options));
  if (options.dry_run) return print(work.plan(cloud, files, run_options(options)));
  std::optional<WholeFile> stats;  // made before the work, so that an unwritable path is refused at once
  if (!options.stats.empty()) stats.emplace(options.stats, options.overwrite);
  std::optional<WholeFile> report;
  if (!options.report.empty()) report.emplace(page_name(options.report), options.overwrite);
  ProgressDisplay display(options);
  RunOptions run = run_options(options);
  RunDisplay watching(display);
  run.observer = &watching;
  for (const std::string& notice : files.notices) display.say(Severity::note, notice);
  const Statistics statistics = work.run(cloud, files, run);
  if (stats) stats->complete(to_json(statistics) + "\n");
  if (report) report->complete(report_of(summary_of(files, cloud, statistics, display)));
  for (const std::string& sentence : about_degenerate(statistics, options.stats))
    display.say(Severity::warning, sentence);
  display.say(Severity::note, conclusion(files, statistics));
}

}  // namespace pointsweep
