// SPDX-License-Identifier: MIT
#include "cli/verbs/common_options.h"

#include <fcntl.h>
#include <fmt/format.h>

#include "cli/console/quantities.h"
#include "cli/text/help.h"
#include "pointsweep/fail.h"
#include "pointsweep/formats/registry.h"
#include "pointsweep/pipeline/language/run_words.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

constexpr int kMostThreads = 4096;

void require_open(int descriptor) {
  if (descriptor < 0 || fcntl(descriptor, F_GETFD) < 0)
    fail_usage("--progress-fd: descriptor {} is not open; redirect it, e.g. {}>progress.jsonl.", descriptor,
               descriptor);
}

/// The flag of an option whose values are words.
void add_words(CLI::App& verb, CommonOptions& options, const char* name, const char* group) {
  const RunWords& declaration = run_words(name);
  verb.add_option_function<std::string>(
          "--" + declaration.name, [&options, name](const std::string& word) { set_word(options, name, word); },
          declaration.meaning)
      ->type_name(fmt::format("{}", fmt::join(declaration.words, "|")))
      ->group(group);
}

}  // namespace

std::vector<std::string> parse_names(const std::string& text) {
  std::vector<std::string> names(1);
  for (const char c : text) c == ',' ? void(names.emplace_back()) : names.back().push_back(c);
  for (const std::string& name : names)
    if (name.empty()) fail_usage("--keep: '{}' is not a list of attributes such as normal,splat_length.", text);
  return names;
}

Order parse_order(std::string_view name) {
  RunOptions options;
  set_word(options, "order", name);
  return options.order;
}

CloudOptions cloud_options(const CommonOptions& options) {
  return {.ignore_crs = options.ignore_crs, .format = options.format};
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

void add_thread_option(CLI::App& verb, CommonOptions& options) {
  options.resources.threads = thread_count();
  verb.add_option("--threads", options.resources.threads, "Number of threads (default: one per processor)")
      ->type_name("N")
      ->group(kMachineGroup)
      ->check(CLI::Range(1, kMostThreads).description(""));
}

void add_force_option(CLI::App& verb, CommonOptions& options) {
  verb.add_flag("-f,--force", options.overwrite, "Overwrite existing outputs")->group(kOutputGroup);
}

void add_crs_option(CLI::App& verb, CommonOptions& options) {
  verb.add_flag("--ignore-crs", options.ignore_crs,
                "Ignore coordinate reference systems: merge inputs of different systems without a transformation, "
                "treat degrees as lengths, do not convert default lengths to feet")
      ->group(kOtherGroup);
}

void add_format_option(CLI::App& verb, std::string& format) {
  verb.add_option("--format", format,
                  "Format of inputs without a signature (all others are recognised by their content)")
      ->type_name(formats_asked_for())
      ->group(kOtherGroup);
}

void add_memory_option(CLI::App& verb, CommonOptions& options, const char* meaning) {
  verb.add_option_function<std::string>(
          "--memory",
          [&options](const std::string& text) { options.resources.memory_bytes = parse_size("--memory", text); },
          meaning)
      ->type_name("SIZE")
      ->group(kMachineGroup);
}

void add_axis_option(CLI::App& verb, CommonOptions& options) { add_words(verb, options, "axis", kMachineGroup); }

void add_stream_options(CLI::App& verb, CommonOptions& options) {
  add_memory_option(
      verb, options,
      "Memory budget of the whole process, e.g. 800M, 2GB or 4GiB, in powers of 1024 (default: half of the available "
      "memory)");
  verb.add_option(
          "--temp-dir", options.resources.temp_folder,
          "Existing folder for temporary files, which a cloud beyond the budget needs (default: that of the system)")
      ->type_name("DIR")
      ->group(kMachineGroup);
  verb.add_option("--resume", options.resume_folder,
                  "Keep checkpoints in this folder. Rerun the command to resume after an interruption")
      ->type_name("DIR")
      ->group(kMachineGroup);
  add_axis_option(verb, options);
  verb.add_option("--stats", options.stats, "Write statistics of the run to this JSON file")
      ->type_name("FILE")
      ->group(kOutputGroup);
  verb.add_option("--report", options.report, "Write a page about the run to this HTML file, with plots and a picture")
      ->type_name("FILE")
      ->group(kOutputGroup);
  // For figures of the sweep and for tests, not for users.
  verb.add_option("--half-way-states", options.half_way_states)->group("");
  verb.add_option("--checkpoint-seconds", options.checkpoint_seconds)->group("")->check(CLI::NonNegativeNumber);
}

void add_keep_option(CLI::App& verb, std::vector<std::string>& keep, const char* meaning) {
  verb.add_option_function<std::string>(
          "--keep", [&keep](const std::string& text) { keep = parse_names(text); }, meaning)
      ->type_name("A,B,...")
      ->group(kOutputGroup);
}

void add_dry_run_option(CLI::App& verb, CommonOptions& options) {
  verb.add_flag("--dry-run", options.dry_run, "Print the plan and the memory it takes; write nothing")
      ->group(kMachineGroup);
}

void add_order_option(CLI::App& verb, CommonOptions& options) { add_words(verb, options, "order", kOutputGroup); }

void add_nonfinite_option(CLI::App& verb, CommonOptions& options) {
  add_words(verb, options, "nonfinite", kOtherGroup);
}

void add_naming_options(CLI::App& verb, CommonOptions& options) {
  verb.add_option("--replace", options.replace,
                  "Allow computed attributes to overwrite these of the input, e.g. curvature,color")
      ->delimiter(',')
      ->type_name("A,B,...")
      ->group(kOutputGroup);
  verb.add_option("--prefix", options.prefix, "Put this before the names of computed attributes")
      ->type_name("NAME")
      ->group(kOutputGroup);
}

void add_provenance_options(CLI::App& verb, CommonOptions& options) {
  add_words(verb, options, "provenance", kOutputGroup);
  verb.add_flag_function(
          "--no-provenance", [&options](std::int64_t) { options.provenance = false; }, "Omit the processing record")
      ->group(kOutputGroup);
}

void add_engine_option(CLI::App& verb, CommonOptions& options) { add_words(verb, options, "engine", kOtherGroup); }

void add_positions_option(CLI::App& verb, CommonOptions& options) {
  add_words(verb, options, "positions", kOutputGroup);
}

}  // namespace pointsweep
