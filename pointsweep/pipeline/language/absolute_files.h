// SPDX-License-Identifier: MIT
/// Makes the file names in a pipeline absolute, for processes that work in other folders.
#pragma once

#include <string>
#include <string_view>

namespace pointsweep {

/// Returns the pipeline with the absolute names of the files, folders and patterns that its options name. An option
/// whose file does not exist stays unchanged, since it may be a text, and so does a stage of an unknown name. Throws
/// the errors of parse_pipeline().
std::string with_absolute_files(std::string_view pipeline);

}  // namespace pointsweep
