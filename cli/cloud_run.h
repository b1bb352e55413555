// SPDX-License-Identifier: MIT
/// What the verbs that run over a whole cloud have in common: inputs, run options, statistics and the last sentence.
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "cli/common_options.h"
#include "pointsweep/pipeline/pipeline.h"

namespace pointsweep {

/// Positional arguments IN... OUT, the last being the output as with cp.
struct InputsAndOutput {
  std::vector<std::filesystem::path> files;
  std::vector<std::filesystem::path> inputs() const { return {files.begin(), files.end() - 1}; }
  const std::filesystem::path& output() const { return files.back(); }
};
void add_inputs_and_output(CLI::App& verb, InputsAndOutput& paths, const char* output_meaning);

/// All groups of common options but --order.
void add_run_options(CLI::App& verb, CommonOptions& options);

/// Opens the inputs as one cloud, lets `work` run over it, shows progress and warnings, writes --stats and says what
/// was done.
void run_over_cloud(const InputsAndOutput& paths, const CommonOptions& options,
                    const std::function<Statistics(Cloud& cloud, const RunOptions& options)>& work);

/// Opens the inputs as one cloud for `work` that writes nothing, without progress and statistics.
void look_at_cloud(const InputsAndOutput& paths, const CommonOptions& options,
                   const std::function<void(Cloud& cloud, const RunOptions& options)>& work);

}  // namespace pointsweep
