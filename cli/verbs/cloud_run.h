// SPDX-License-Identifier: MIT
/// The common part of the verbs that run over a whole cloud: inputs, run options, statistics and the last sentence.
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "cli/verbs/common_options.h"
#include "cli/verbs/inputs_and_output.h"

namespace pointsweep {

/// Makes standard input readable if it is one of the inputs ("-"); a pipe is copied to the temporary folder.
void take_standard_input(const std::vector<std::filesystem::path>& inputs, const CommonOptions& options);

/// --dry-run and all groups of common options but --order, --engine and --keep.
void add_run_options(CLI::App& verb, CommonOptions& options);

/// Opens the inputs as one cloud, lets `work` run over it, shows progress and warnings, writes --stats and says what
/// was done.
void run_over_cloud(
    const InputsAndOutput& paths, const CommonOptions& options,
    const std::function<Statistics(InputCloud& cloud, const ResolvedFiles& files, const EngineOptions& options)>& work);

/// Opens the inputs as one cloud for `work` that writes nothing, without progress and statistics.
void look_at_cloud(
    const InputsAndOutput& paths, const CommonOptions& options,
    const std::function<void(InputCloud& cloud, const ResolvedFiles& files, const EngineOptions& options)>& work);

}  // namespace pointsweep
