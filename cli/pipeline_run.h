// SPDX-License-Identifier: MIT
/// What the verbs that run a pipeline of named operators have in common.
#pragma once

#include <string>
#include <vector>

#include "cli/cloud_run.h"
#include "pointsweep/pipeline/parse.h"

namespace pointsweep {

struct PipelineRun {
  CommonOptions common;
  InputsAndOutput paths;
  std::vector<std::string> keep;  ///< names of attributes; empty: all
  bool dry = false;
};

/// --keep
void add_keep_option(CLI::App& verb, std::vector<std::string>& keep, const char* meaning);
/// --keep, --dry-run, --order, --engine and all common options. `run` outlives the parsing.
void add_pipeline_options(CLI::App& verb, PipelineRun& run);

/// Builds the chain for the cloud and runs it, or says what would be done.
void run_stages(const std::vector<StageText>& stages, const PipelineRun& run);

}  // namespace pointsweep
