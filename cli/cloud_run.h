// SPDX-License-Identifier: MIT
/// What the verbs that run over a whole cloud have in common: inputs, run options, statistics and the last sentence.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <vector>

#include "cli/common_options.h"
#include "pointsweep/pipeline/engine_run.h"

namespace pointsweep {

/// Positional arguments IN... OUT: the last is the output, as with cp. With --output OUT all of them are inputs.
struct InputsAndOutput {
  std::vector<std::filesystem::path> files;
  std::filesystem::path named_output;                ///< of --output; empty: the last of `files`
  std::vector<std::filesystem::path> other_inputs;   ///< files that are read in addition to points
  std::vector<std::filesystem::path> other_outputs;  ///< files that are written in addition to OUT

  std::size_t inputs_named() const { return files.size() - (named_output.empty() && !files.empty() ? 1 : 0); }
  std::vector<std::filesystem::path> inputs() const {
    return {files.begin(), files.begin() + static_cast<std::ptrdiff_t>(inputs_named())};
  }
  const std::filesystem::path& output() const { return named_output.empty() ? files.back() : named_output; }
};
/// IN... OUT. `output_meaning` goes on after "then output", e.g. "with the attributes of the input".
void add_inputs_and_output(CLI::App& verb, InputsAndOutput& paths, const char* output_meaning);
/// -o, --output
void add_output_option(CLI::App& verb, std::filesystem::path& output);

/// Makes standard input readable if it is one of the inputs ("-"); a pipe is copied to the temporary folder.
void take_standard_input(const std::vector<std::filesystem::path>& inputs, const CommonOptions& options);

/// Throws UsageError where no input or no output is named, where a list of several inputs ends with a file that exists
/// (a pattern such as *.las with OUT forgotten), and where an output is an input or another output.
void require_named_files(const InputsAndOutput& paths);

/// --dry-run and all groups of common options but --order, --engine and --keep.
void add_run_options(CLI::App& verb, CommonOptions& options);

/// Opens the inputs as one cloud, lets `work` run over it, shows progress and warnings, writes --stats and says what
/// was done.
void run_over_cloud(const InputsAndOutput& paths, const CommonOptions& options,
                    const std::function<Statistics(InputCloud& cloud, const EngineOptions& options)>& work);

/// Opens the inputs as one cloud for `work` that writes nothing, without progress and statistics.
void look_at_cloud(const InputsAndOutput& paths, const CommonOptions& options,
                   const std::function<void(InputCloud& cloud, const EngineOptions& options)>& work);

}  // namespace pointsweep
