// SPDX-License-Identifier: MIT
/// The options that several verbs share, declared once. A verb takes the groups that mean something to it.
#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/pipeline/engine_run.h"

namespace pointsweep {

/// The options of a run, and what the tool alone needs to know.
struct CommonOptions : EngineOptions {
  std::filesystem::path stats;    ///< JSON file; empty: none
  std::filesystem::path report;   ///< HTML page; empty: none
  std::vector<std::string> keep;  ///< names of attributes to write; empty: all
  bool dry_run = false;           ///< print the plan and write nothing
  bool quiet = false;
  std::string format;            ///< format of inputs without a signature; empty: there are none
  bool ignore_crs = false;       ///< coordinate reference systems neither forbid nor convert anything
  int progress_descriptor = -1;  ///< for one JSON object per line; -1: none
};

/// Returns the rules by which the inputs become one cloud.
CloudOptions cloud_options(const CommonOptions& options);

/// --quiet, --progress-fd N
void add_progress_options(CLI::App& verb, CommonOptions& options);
/// --threads N
void add_thread_option(CLI::App& verb, CommonOptions& options);
/// --ignore-crs
void add_crs_option(CLI::App& verb, CommonOptions& options);
/// --format
void add_format_option(CLI::App& verb, std::string& format);
/// --force
void add_force_option(CLI::App& verb, CommonOptions& options);
/// --memory SIZE, --temp-dir DIR, --resume DIR, --axis, --stats FILE, --report FILE and, hidden, --half-way-states FILE
/// and --checkpoint-seconds S
void add_stream_options(CLI::App& verb, CommonOptions& options);
/// --order
void add_order_option(CLI::App& verb, CommonOptions& options);
/// --engine
void add_engine_option(CLI::App& verb, CommonOptions& options);
/// --positions float32|float64
void add_positions_option(CLI::App& verb, CommonOptions& options);
/// --memory SIZE
void add_memory_option(CLI::App& verb, CommonOptions& options, const char* meaning);
/// The names of a list "a,b,c". Throws UsageError for an empty one.
std::vector<std::string> parse_names(const std::string& text);
/// --keep A,B,...
inline constexpr const char* kKeepMeaning =
    "Write only these attributes, by name or by column, e.g. normal or x,y,z,intensity,nx. Where no computed attribute "
    "is named, all of them are written; where none of the input is named, all of those (default: all)";
void add_keep_option(CLI::App& verb, std::vector<std::string>& keep, const char* meaning);
/// --dry-run
void add_dry_run_option(CLI::App& verb, CommonOptions& options);
/// --nonfinite
void add_nonfinite_option(CLI::App& verb, CommonOptions& options);
/// --replace A,B,... and --prefix NAME
void add_naming_options(CLI::App& verb, CommonOptions& options);
/// --provenance names|paths and --no-provenance
void add_provenance_options(CLI::App& verb, CommonOptions& options);
/// --axis
void add_axis_option(CLI::App& verb, CommonOptions& options);
/// "input" or "sweep"; throws UsageError for anything else.
Order parse_order(std::string_view name);

}  // namespace pointsweep
