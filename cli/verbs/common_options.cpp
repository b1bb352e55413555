// SPDX-License-Identifier: MIT
#include "cli/verbs/common_options.h"

#include <fcntl.h>
#include <fmt/format.h>

#include "cli/console/console.h"
#include "cli/text/help.h"
#include "pointsweep/program/formats.h"

namespace pointsweep {
namespace {

void require_open(int descriptor) {
  if (descriptor < 0 || fcntl(descriptor, F_GETFD) < 0)
    refuse("--progress-fd: descriptor {} is not open; redirect it, e.g. {}>progress.jsonl.", descriptor, descriptor);
}

const char* group_of(const RunOption& option) {
  switch (option.group) {
    case RunOption::Group::output:
      return kOutputGroup;
    case RunOption::Group::machine:
      return kMachineGroup;
    case RunOption::Group::other:
      break;
  }
  return kOtherGroup;
}

}  // namespace

void add_run_option(CLI::App& verb, RunOptions& options, std::string_view name, const char* meaning,
                    const char* other_flag) {
  const RunOption& declared = run_option(name);
  const std::string named = other_flag != nullptr ? other_flag : declared.flag;
  const std::string text = meaning != nullptr ? meaning : declared.meaning;
  const auto set = [&options, &declared, named](const std::string& value) {
    declared.set(options, value, named.substr(named.find("--")));
  };
  CLI::Option* const flag = declared.value.empty() ? verb.add_flag_callback(
                                                         named, [set] { set(kSwitchedOn); }, text)
                                                   : verb.add_option_function<std::string>(named, set, text);
  flag->type_name(declared.value)->group(group_of(declared));
}

void add_named_options(CLI::App& verb, RunOptions& options, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) add_run_option(verb, options, name);
}

std::map<std::string, std::string> texts_of(const RunOptions& options) {
  std::map<std::string, std::string> texts;
  for (const RunOption& option : run_options())
    if (const std::string text = option.text(options); !text.empty()) texts[option.name] = text;
  return texts;
}

CloudOptions cloud_options(const CommonOptions& options) {
  CloudOptions cloud{.ignore_crs = options.ignore_crs, .crs = options.crs, .format = options.format};
  if (options.replace_crs && !cloud.crs) refuse("--replace-crs: belongs to --crs; name the system, or leave it out.");
  if (cloud.crs) cloud.crs->replaces = options.replace_crs;
  return cloud;
}

void add_progress_options(CLI::App& verb, CommonOptions& options) {
  verb.add_flag("-q,--quiet", options.quiet, "Print errors only")->group(kOtherGroup);
  verb.add_option_function<int>(
          "--progress-fd",
          [&options](int descriptor) {
            require_open(descriptor);
            options.progress_descriptor = descriptor;
          },
          "Write progress to this open file descriptor, one JSON object per line")
      ->type_name("N")
      ->group(kOtherGroup);
}

void add_crs_option(CLI::App& verb, CommonOptions& options) {
  verb.add_flag("--ignore-crs", options.ignore_crs,
                "Ignore coordinate reference systems: merge inputs of different systems without a transformation, "
                "treat degrees as lengths, do not convert default lengths to feet")
      ->group(kOtherGroup);
}

void add_stated_crs_option(CLI::App& verb, CommonOptions& options) {
  verb.add_option_function<std::string>(
          "--crs",
          [&options](const std::string& text) {
            options.crs = StatedCrs{parse_crs(text), false};
          },
          "State the coordinate reference system of the inputs and the output: a code, a file with WKT (.prj), or "
          "none. Coordinates do not change")
      ->type_name("EPSG:CODE|FILE|none")
      ->group(kOutputGroup);
}

void add_stated_crs_options(CLI::App& verb, CommonOptions& options) {
  add_stated_crs_option(verb, options);
  verb.add_flag("--replace-crs", options.replace_crs, "Let --crs replace another system that an input states")
      ->group(kOutputGroup);
}

namespace {

/// Adds an option that sets `format`, the format of the inputs, to `begin` followed by its value, e.g. "depth:4". At
/// most one of these options may be used.
void add_format_word(CLI::App& verb, std::string& format, const char* flag, const char* begin, const char* meaning,
                     const char* value) {
  verb.add_option_function<std::string>(
          flag,
          [&format, flag, begin](const std::string& text) {
            if (!format.empty()) refuse("{}: another option says how the inputs are read; leave one out.", flag);
            format = begin + text;
            require_format_asked_for(format);
          },
          meaning)
      ->type_name(value)
      ->group(kOtherGroup);
}

}  // namespace

void add_format_option(CLI::App& verb, std::string& format) {
  verb.add_option("--format", format,
                  "Format of inputs without a signature (all others are recognised by their content)")
      ->type_name(formats_asked_for())
      ->group(kOtherGroup);
  add_format_word(
      verb, format, "--columns", "text:",
      "Names of the columns of text inputs without a header, e.g. x,y,z,intensity,-,red,green,blue; - skips a column",
      "A,B,...");
  add_format_word(verb, format, "--depth",
                  "depth:", "Read the levels of detail of COPC inputs up to this depth, of which 0 is the coarsest",
                  "N");
  add_format_word(verb, format, "--resolution", "spacing:",
                  "Read as many levels of detail of COPC inputs as it takes until points lie no farther apart",
                  "DISTANCE");
}

void add_stream_options(CLI::App& verb, CommonOptions& options) {
  add_named_options(verb, options, {"memory", "temp_folder", "resume", "axis"});
  verb.add_option("--stats", options.stats, "Write statistics of the run to this JSON file")
      ->type_name("FILE")
      ->group(kOutputGroup);
  verb.add_option("--report", options.report, "Write a page about the run to this HTML file, with plots and a picture")
      ->type_name("FILE")
      ->group(kOutputGroup);
  // Options that the help does not show: for the pictures of the sweep in docs/, and for tests.
  verb.add_option("--half-way-states", options.half_way_states)->group("");
  verb.add_option("--checkpoint-seconds", options.checkpoint_seconds)->group("")->check(CLI::NonNegativeNumber);
}

void add_keep_option(CLI::App& verb, std::vector<std::string>& keep, const char* meaning) {
  verb.add_option_function<std::string>(
          "--keep", [&keep](const std::string& text) { keep = parse_names("--keep", text); }, meaning)
      ->type_name("A,B,...")
      ->group(kOutputGroup);
}

void add_dry_run_option(CLI::App& verb, CommonOptions& options) {
  verb.add_flag("--dry-run", options.dry_run, "Print the plan and the memory it takes; write nothing")
      ->group(kMachineGroup);
}

}  // namespace pointsweep
