// SPDX-License-Identifier: MIT
/// The options and the start of a run that the Python package performs on the workers of Dask: over a folder of tiles,
/// or with an output that is divided among files.
#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "cli/verbs/cloud_run.h"

namespace pointsweep {

void add_cluster_options(CLI::App& verb, ClusterOptions& options);

/// Replaces this process by a process of the Python package, which performs the run. `stages`: texts of
/// canonical_stages(). Throws UsageError for options that such a run does not have, and Error if Python cannot be
/// started.
[[noreturn]] void run_on_cluster(const std::vector<std::string>& stages, const PipelineRun& run);

}  // namespace pointsweep
