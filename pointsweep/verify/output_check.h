// SPDX-License-Identifier: MIT
/// A check of files: the processing record of an output gives the run, and so the stages that can be checked.
#pragma once

#include <filesystem>
#include <vector>

#include "pointsweep/pipeline/language/parse.h"
#include "pointsweep/verify.h"

namespace pointsweep {

/// Implements verify() of the public header. `neighborhood`: the options of knn as text, with their places for
/// messages.
Verdict verify_output(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& output,
                      const VerifyOptions& options, const std::vector<OptionText>& neighborhood);

}  // namespace pointsweep
