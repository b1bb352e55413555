// SPDX-License-Identifier: MIT
/// `pointsweep info FILE...`: the contents of point files, found by reading all points; with --quick, and for URLs
/// unless more is asked for, the contents of their headers.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "cli/console/console.h"
#include "cli/text/file_text.h"
#include "cli/verbs/cloud_run.h"
#include "cli/verbs/commands.h"
#include "cli/verbs/common_options.h"
#include "cli/verbs/progress.h"
#include "pointsweep/cancellation.h"
#include "pointsweep/files.h"
#include "pointsweep/info.h"
#include "pointsweep/url.h"

namespace pointsweep {
namespace {

struct InfoCommand {
  CommonOptions common;
  std::vector<std::filesystem::path> files;  ///< may contain folders, patterns and .vpc files
  bool recursive = false;
  bool json = false, table = false;
  bool spacing = true;
  bool quick = false;  ///< true to read only headers
  bool check = false;  ///< true if warnings count as failures
  PointStatisticsOptions statistics;

  bool has_statistics() const { return !statistics.by.empty() || statistics.values || !statistics.histograms.empty(); }
};

enum class InfoStyle : std::uint8_t { details, table, json };

/// The JSON object of `info`. The object is printed file by file, since there may be many files.
class PrintedJson {
 public:
  void add(const nlohmann::ordered_json& file) {
    begin();
    print((files_++ == 0 ? "\n    " : ",\n    ") + text_of(file, "\n    "));
  }
  void finish(const nlohmann::ordered_json& all, const nlohmann::ordered_json& statistics) {
    begin();
    print((files_ == 0 ? "],\n  \"all\": " : "\n  ],\n  \"all\": ") + text_of(all, "\n  ") +
          ",\n  \"statistics\": " + text_of(statistics, "\n  ") + "\n}\n");
  }

 private:
  void begin() {
    if (!std::exchange(begun_, true)) print("{\n  \"files\": [");
  }
  /// Returns a value as indented JSON. `line`: a line feed and the indentation of the value.
  static std::string text_of(const nlohmann::ordered_json& value, const std::string& line) {
    std::string text;
    for (const char c : value.dump(2, ' ', false, nlohmann::json::error_handler_t::replace))
      c == '\n' ? text += line : text += c;
    return text;
  }

  bool begun_ = false;
  std::size_t files_ = 0;
};

nlohmann::ordered_json box_as_json(const Box& box) {
  if (box.empty()) return {};
  const auto corner = [](Vec3 v) { return nlohmann::ordered_json{v.x + 0.0, v.y + 0.0, v.z + 0.0}; };  // -0 becomes 0
  return {{"min", corner(box.lo)}, {"max", corner(box.hi)}};
}

/// Prints the report: first a part for each file, then the part about all files together.
class InfoReport {
 public:
  explicit InfoReport(InfoStyle style) : style_(style) {}

  /// Adds a file. `label`: its name in tables and in sentences about several files.
  void add(FileSummary summary, const std::filesystem::path& label) {
    if (style_ == InfoStyle::json) json_.add(nlohmann::ordered_json::parse(to_json(summary)));
    if (style_ == InfoStyle::details) print(to_text(summary));
    faulty_ += summary.info.warnings.empty() ? 0 : 1;
    summary.info.path = label;
    if (style_ == InfoStyle::table) table_.add(summary);
    totals_.add(summary);
    comparison_.add(summary);
  }
  void add_failure(const std::filesystem::path& file, const std::string& sentence, const std::filesystem::path& label) {
    if (style_ == InfoStyle::json) json_.add({{"path", file.string()}, {"error", sentence}});
    if (style_ == InfoStyle::table) table_.add_unreadable(label);
    totals_.add_unreadable();
  }
  /// Ends the report. `statistics`: statistics of the points of all readable files; absent if not requested.
  void finish(const std::optional<PointStatistics>& statistics) {
    if (style_ == InfoStyle::json)
      return json_.finish(all_as_json(),
                          statistics ? nlohmann::ordered_json::parse(to_json(*statistics)) : nlohmann::ordered_json());
    if (style_ == InfoStyle::table) print(table_.text());
    if (files() > 1) print(totals_.text(comparison_.sentences()));
    if (statistics) print(to_text(*statistics));
  }
  std::size_t files() const { return totals_.files(); }
  std::size_t failures() const { return totals_.unreadable(); }
  /// Returns the number of files with warnings.
  std::size_t faulty() const { return faulty_; }

 private:
  nlohmann::ordered_json all_as_json() const {
    const std::optional<double> density = totals_.density();
    return {{"files", files()},
            {"unreadable", failures()},
            {"points", totals_.points()},
            {"bounds", box_as_json(totals_.bounds())},
            {"density", density ? nlohmann::ordered_json(*density) : nullptr},
            {"inconsistent", comparison_.sentences()}};
  }

  InfoStyle style_;
  PrintedJson json_;
  FileTable table_;
  FileTotals totals_;
  FileComparison comparison_;
  std::size_t faulty_ = 0;
};

/// A file and its name in tables: its path below the named folder if that was the only argument.
struct LabelledFile {
  std::filesystem::path path, label;
};

/// Opens files as one cloud. Their coordinate reference systems may differ.
Cloud open_as_one(const std::vector<std::filesystem::path>& files, const InfoCommand& options) {
  return Cloud(files, {.ignore_crs = true, .format = options.common.format});
}

void look_at_file(const LabelledFile& file, const InfoCommand& options, bool spacing, InfoReport& report,
                  ProgressDisplay& progress) {
  const std::unique_ptr<Reader> reader = open_reader(file.path, options.common.format);
  const auto show = [&](std::uint64_t done, std::uint64_t total) {
    stop_if_cancelled();
    progress.report("info", done, total);
  };
  // The points of a URL are read only if the request needs more than the header.
  const bool headers_only = options.quick || (is_url(file.path) && !options.has_statistics() && !options.check);
  FileSummary summary =
      headers_only ? summarize_header(*reader) : summarize(*reader, {.spacing = spacing, .progress = show});
  const std::string path = file.path.string();
  for (const std::string& warning : summary.info.warnings)
    progress.say(Severity::warning, warning.starts_with(path) ? warning : fmt::format("{}: {}", path, warning));
  report.add(std::move(summary), file.label);
}

/// Returns the files for which an argument stands. If there are none, reports an error and returns an empty list.
std::vector<LabelledFile> files_of(const std::filesystem::path& named, const InfoCommand& options, InfoReport& report,
                                   ProgressDisplay& progress) {
  const bool is_folder = options.files.size() == 1 && stands_for_files(named);
  std::vector<LabelledFile> files;
  try {
    const InputList list = list_inputs({named}, options.recursive, options.common.format);
    for (const ListedFile& file : list.files) files.push_back({file.path, is_folder ? file.relative : file.path});
    for (const std::string& notice : list.notices) progress.say(Severity::note, notice);
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& error) {
    progress.say(Severity::error, error.what());
    report.add_failure(named, error.what(), named);
  }
  return files;
}

InfoStyle style_of(const InfoCommand& options) {
  if (options.json) return InfoStyle::json;
  const bool many = std::ranges::any_of(options.files, stands_for_files);
  return options.table || many ? InfoStyle::table : InfoStyle::details;
}

/// Returns the statistics of the points of the files, which must be readable.
PointStatistics statistics_of(const std::vector<std::filesystem::path>& files, const InfoCommand& options,
                              ProgressDisplay& progress) {
  Cloud cloud = open_as_one(files, options);
  for (const std::string& warning : cloud.warnings()) progress.say(Severity::warning, warning);
  PointStatisticsOptions asked = options.statistics;
  asked.progress = [&](unsigned reading, std::uint64_t done, std::uint64_t total) {
    stop_if_cancelled();
    progress.report(fmt::format("statistics, reading {}", reading), done, total);
  };
  return point_statistics(cloud, asked);
}

/// Returns the statistics of the points of all files; none if not requested, or if a file cannot be read. Throws
/// UsageError for wrong options.
std::optional<PointStatistics> statistics_if_readable(const std::vector<std::filesystem::path>& files,
                                                      const InfoCommand& options, ProgressDisplay& progress) {
  if (!options.has_statistics() || files.empty()) return std::nullopt;
  try {
    return statistics_of(files, options, progress);
  } catch (const Cancelled&) {
    throw;
  } catch (const UsageError&) {
    throw;
  } catch (const Error&) {
    return std::nullopt;
  }
}

void info(const InfoCommand& options) {
  const InfoStyle style = style_of(options);
  const bool spacing = style != InfoStyle::table && options.spacing;
  InfoReport report(style);
  ProgressDisplay progress(options.common);
  take_standard_input(options.files, options.common);
  std::vector<LabelledFile> files;
  for (const auto& named : options.files) {
    const auto some = files_of(named, options, report, progress);
    files.insert(files.end(), some.begin(), some.end());
  }
  std::vector<std::filesystem::path> paths, readable;
  for (const LabelledFile& file : files) paths.push_back(file.path);
  // Statistics come first, so that a wrong name of an attribute is refused at once.
  std::optional<PointStatistics> statistics = statistics_if_readable(paths, options, progress);
  for (const LabelledFile& file : files) {
    try {
      look_at_file(file, options, spacing, report, progress);
      readable.push_back(file.path);
    } catch (const Cancelled&) {
      throw;
    } catch (const Error& error) {
      progress.say(Severity::error, error.what());
      report.add_failure(file.path, error.what(), file.label);
    }
  }
  if (options.has_statistics() && !statistics && !readable.empty())
    statistics = statistics_of(readable, options, progress);
  report.finish(statistics);
  if (report.failures() > 0)
    throw Error(fmt::format("{} of {} files could not be read.", report.failures(), report.files()));
  if (options.check && report.faulty() > 0)
    throw Error(fmt::format("{} of {} files have the faults that the warnings name.", report.faulty(), report.files()));
}

/// Adds --by, --stats, --keep, --histogram and --bins.
void add_statistics_options(CLI::App& verb, PointStatisticsOptions& asked, CLI::Option* quick) {
  verb.add_option("--by", asked.by, "Count the points of each value of this attribute, e.g. classification")
      ->type_name("ATTRIBUTE")
      ->excludes(quick);
  CLI::Option* const stats =
      verb.add_flag("--stats", asked.values,
                    "Show count, range, mean, standard deviation and quantiles of each attribute, with --by those of "
                    "each value")
          ->excludes(quick);
  verb.add_option("--keep", asked.keep, "Show the statistics of these attributes alone, e.g. z,intensity")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("A,B,...")
      ->needs(stats);
  CLI::Option* const histogram =
      verb.add_option("--histogram", asked.histograms, "Count the values of these attributes in bins, e.g. z")
          ->delimiter(',')
          ->allow_extra_args(false)
          ->type_name("A,B,...")
          ->excludes(quick);
  verb.add_option("--bins", asked.bins, "Divide a histogram into this many bins at most (default: 20)")
      ->type_name("NUMBER")
      ->needs(histogram);
}

}  // namespace

void declare_info_verb(CLI::App& verb) {
  auto options = std::make_shared<InfoCommand>();
  verb.add_option("FILE", options->files, "Point files, folders of them or quoted patterns")->required()->type_name("");
  add_recursive_option(verb, options->recursive);
  CLI::Option* json = verb.add_flag("--json", options->json, "Write one JSON object; docs/info.md lists its keys");
  verb.add_flag("--table", options->table,
                "Write one line for each file, read once (default for folders, patterns and .vpc files)")
      ->excludes(json);
  CLI::Option* no_spacing = verb.add_flag_callback(
      "--no-spacing", [options] { options->spacing = false; },
      "Read files once instead of twice, without the distances between points");
  CLI::Option* quick =
      verb.add_flag("--quick", options->quick, "Read headers only: counts, bounds and attributes as these state them")
          ->excludes(no_spacing);
  add_statistics_options(verb, options->statistics, quick);
  verb.add_flag(
      "--check", options->check,
      "End with status 1 where a warning names a fault of a file, such as bounds that are not those of the points");
  add_format_option(verb, options->common.format);
  add_progress_options(verb, options->common);
  verb.footer(
      "Without --quick files are read to their end: bounds, counts and ranges are those of the points, not of a "
      "header.\n"
      "A file that cannot be read is reported; the others are still read, and the exit status is 1.\n"
      "Several files are compared: formats, coordinate reference systems, attributes and their types.\n"
      "Statistics are those of the points of all files together.\n"
      "\nExamples:\n"
      "  pointsweep info scan.ply\n"
      "  pointsweep info tiles/\n"
      "  pointsweep info --quick --recursive survey/\n"
      "  pointsweep info --check delivery/\n"
      "  pointsweep info --by classification --stats --keep z,intensity scan.laz\n"
      "  pointsweep info --histogram z tiles/\n"
      "  pointsweep info --table tile_*.las");
  verb.callback([options] { info(*options); });
}

}  // namespace pointsweep
