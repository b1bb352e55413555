// SPDX-License-Identifier: MIT
/// The options that several verbs share, declared once; a verb adds the groups that it supports. The inputs and the
/// output of a verb, as the user names them and as the files for which they stand.
#pragma once

#include <CLI/App.hpp>
#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/cloud.h"
#include "pointsweep/program/quantities.h"
#include "pointsweep/program/run_options.h"

namespace pointsweep {

/// The options of a run on many machines.
struct ClusterOptions {
  std::string dask;  ///< address of the scheduler, or "local"; empty for a run in one process
  std::filesystem::path scratch;
  bool take_over = false;
};

struct CommonOptions : RunOptions {
  std::filesystem::path stats;    ///< JSON file for statistics; empty for none
  std::filesystem::path report;   ///< HTML page about the run; empty for none
  std::vector<std::string> keep;  ///< names of attributes to write; empty for all
  bool dry_run = false;           ///< true to print the plan and write nothing
  bool quiet = false;
  std::string format;            ///< CloudOptions::format by --format, --columns, --depth or --resolution; may be empty
  std::optional<StatedCrs> crs;  ///< system stated by --crs; absent to use the systems of the inputs
  bool replace_crs = false;      ///< true if `crs` replaces systems that the inputs state
  bool ignore_crs = false;       ///< true to read inputs without comparing or converting coordinate systems
  int progress_descriptor = -1;  ///< descriptor that receives one JSON object per line; -1 for none
  ClusterOptions cluster;
};

/// Returns the texts of all run options that differ from their defaults, by the names of the options.
std::map<std::string, std::string> texts_of(const RunOptions& options);

/// Returns the rules by which the inputs become one cloud.
CloudOptions cloud_options(const CommonOptions& options);

/// Adds the flag of the run option `name`. `meaning`: sentence for the help; null for the sentence of the declaration.
/// `flag`: name of the flag; null for the flag of the declaration.
void add_run_option(CLI::App& verb, RunOptions& options, std::string_view name, const char* meaning = nullptr,
                    const char* flag = nullptr);
void add_named_options(CLI::App& verb, RunOptions& options, std::initializer_list<std::string_view> names);
/// Adds --quiet and --progress-fd N.
void add_progress_options(CLI::App& verb, CommonOptions& options);
/// Adds --ignore-crs.
void add_crs_option(CLI::App& verb, CommonOptions& options);
/// Adds --crs EPSG:CODE|FILE|none.
void add_stated_crs_option(CLI::App& verb, CommonOptions& options);
/// Adds --crs EPSG:CODE|FILE|none and --replace-crs.
void add_stated_crs_options(CLI::App& verb, CommonOptions& options);
/// Adds --format, and the options --columns, --depth and --resolution, which store "text:A,B,...", "depth:N" and
/// "spacing:DISTANCE" in `format`.
void add_format_option(CLI::App& verb, std::string& format);
/// Adds --memory SIZE, --temp-dir DIR, --resume DIR, --axis, --stats FILE, --report FILE and, hidden in the help,
/// --half-way-states FILE and --checkpoint-seconds S.
void add_stream_options(CLI::App& verb, CommonOptions& options);
/// Meaning of --keep A,B,... for the help.
inline constexpr const char* kKeepMeaning =
    "Write only these attributes, by name or by column, e.g. normal or x,y,z,intensity,nx; x, y and z are always "
    "written. Columns have the order of this list, except in LAS files. A list without computed attributes keeps all "
    "computed attributes; a list without attributes of the input keeps all attributes of the input (default: all)";
void add_keep_option(CLI::App& verb, std::vector<std::string>& keep, const char* meaning);
/// Adds --dry-run.
void add_dry_run_option(CLI::App& verb, CommonOptions& options);
/// Positional arguments IN... OUT: the last is the output, as with cp. With --output OUT all of them are inputs.
struct InputsAndOutput {
  std::vector<std::filesystem::path> files;
  std::filesystem::path named_output;                ///< value of --output; if empty, the last of `files` is the output
  bool recursive = false;                            ///< true with --recursive
  std::string output_format;                         ///< value of --output-format; empty for the format of each input
  bool divides = false;                              ///< true if OUT is a folder for files that the run names
  bool resumes = false;                              ///< true if OUT may hold outputs of an earlier process
  std::vector<std::filesystem::path> other_inputs;   ///< files that are read in addition to points
  std::vector<std::filesystem::path> other_outputs;  ///< files that are written in addition to OUT

  std::size_t inputs_named() const { return files.size() - (named_output.empty() && !files.empty() ? 1 : 0); }
  std::vector<std::filesystem::path> inputs() const {
    return {files.begin(), files.begin() + static_cast<std::ptrdiff_t>(inputs_named())};
  }
  const std::filesystem::path& output() const { return named_output.empty() ? files.back() : named_output; }
};

/// The files to read and to write.
struct ResolvedFiles {
  std::vector<std::filesystem::path> inputs;  ///< point files, those of folders, patterns and .vpc files included
  std::filesystem::path output;               ///< output, with a * in its name if the run divides it among files
  std::vector<std::filesystem::path> tiles;   ///< an output for each input if `output` is a folder; else empty
  std::vector<std::string> notices;           ///< sentences about files that are left out
};

/// Adds IN... OUT and --recursive. `output_meaning` follows "then output" in the help, e.g. "with the attributes of the
/// input".
void add_files(CLI::App& verb, InputsAndOutput& paths, const std::string& output_meaning);
/// Adds the arguments and options of add_files(), and -o, --output.
void add_inputs_and_output(CLI::App& verb, InputsAndOutput& paths, const std::string& output_meaning);
/// Adds --recursive.
void add_recursive_option(CLI::App& verb, bool& recursive);
/// Adds --output-format.
void add_output_format_option(CLI::App& verb, std::string& format);
/// Adds -o, --output.
void add_output_option(CLI::App& verb, std::filesystem::path& output);

/// Lists the files that a command reads and writes (pointsweep/files.h). `format`: value of --format, or "". If OUT is
/// a folder or ends in '/', each input gets an output in this folder, unless `named.divides`. Throws UsageError for
/// names that do not fit together: if no input or no output is named, if the last of three or more names is an existing
/// file or folder of point files (the user has probably forgotten OUT after a pattern), if an output is an input or
/// another output or would be an input of a later run, or if the outputs have no format that can be written. Throws
/// Error for a missing input or a folder without point files.
ResolvedFiles resolve(const InputsAndOutput& named, const std::string& format);

/// Throws UsageError, with the reason, if the output of a verb that makes one output of all inputs is a folder.
void require_one_output(const ResolvedFiles& files, const char* reason);

}  // namespace pointsweep
