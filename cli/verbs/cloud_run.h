// SPDX-License-Identifier: MIT
/// Functions that several verbs share. Verbs that run over a whole cloud share inputs, run options, statistics and the
/// final message; verbs that run a pipeline of named operators also share the options of stages as flags.
#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/verbs/common_options.h"
#include "pointsweep/program/pipeline.h"

namespace pointsweep {

/// Makes standard input readable if it is one of the inputs ("-"); a pipe is copied to the temporary folder.
void take_standard_input(const std::vector<std::filesystem::path>& inputs, const CommonOptions& options);

/// Adds --dry-run, --nonfinite, --threads, --ignore-crs, --force, and the options of add_stream_options(),
/// add_format_option() and add_progress_options().
void add_run_options(CLI::App& verb, CommonOptions& options);

/// The work of a verb over a whole cloud.
struct CloudWork {
  std::function<Statistics(Cloud&, const ResolvedFiles&, const RunOptions&)> run;
  std::function<std::string(Cloud&, const ResolvedFiles&, const RunOptions&)> plan;  ///< describes `run`, for --dry-run
};

/// Opens the inputs as one cloud and runs the work over it: shows progress and warnings, writes --stats and --report,
/// and prints a summary. With --dry-run, prints the plan and writes nothing.
void run_over_cloud(const InputsAndOutput& paths, const CommonOptions& options, const CloudWork& work);

/// Returns whether the option `name` is among `options`.
bool gives(const std::vector<OptionText>& options, std::string_view name);

/// Adds a flag for each option: "--f" for the option f, "--k-from" for k_from. Values on the command line are appended
/// to `into`, which must outlive the parsing.
void add_stage_options(CLI::App& verb, const std::vector<OptionDeclaration>& options, std::vector<OptionText>& into);

/// Adds one option under the given flag.
void add_stage_option(CLI::App& verb, const std::string& flag, const OptionDeclaration& option,
                      std::vector<OptionText>& into);

/// Adds -k, --radius and other options of neighbourhoods. `k`: the default of the verb for the help; empty if the
/// pipeline decides.
void add_neighborhood_options(CLI::App& verb, const std::string& k, std::vector<OptionText>& into);

struct PipelineRun {
  CommonOptions common;
  InputsAndOutput paths;
  std::vector<OptionText> orientation;  ///< options for all stages `normals`; empty if the user states none
};

/// Adds the options of the operator `normals` and of add_output_options(). `run` must outlive the parsing.
void add_pipeline_options(CLI::App& verb, PipelineRun& run);

/// Adds the options that divide the output among files, and the options of add_file_options().
void add_output_options(CLI::App& verb, PipelineRun& run);
/// Adds the options on the contents and layout of output files, --order, --engine, --crs, --replace-crs, and the
/// options of add_run_options() and add_cluster_options().
void add_file_options(CLI::App& verb, PipelineRun& run);

/// Gives every stage `normals` the orientation. Throws UsageError if there is no such stage, if a stage states an
/// orientation itself, or if the orientation is that of a viewpoint which is not given. Does nothing if `orientation`
/// is empty.
void orient_normals(std::vector<StageText>& stages, const std::vector<OptionText>& orientation);

/// Adds --dask, --scratch and --take-over.
void add_cluster_options(CLI::App& verb, ClusterOptions& options);

/// Replaces this process by a process of the Python package, which performs the run. `stages`: texts of
/// canonical_stages(). Throws UsageError for options that such a run does not have, and Error if Python cannot be
/// started.
[[noreturn]] void run_on_cluster(const std::vector<std::string>& stages, const PipelineRun& run);

/// Builds the chain for the cloud and runs it. With --dry-run, prints the plan instead; with --dask, replaces this
/// process by run_on_cluster().
void run_stages(std::vector<StageText> stages, const PipelineRun& run);

}  // namespace pointsweep
