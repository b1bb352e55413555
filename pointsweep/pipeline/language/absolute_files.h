// SPDX-License-Identifier: MIT
/// Pipelines for processes that work in other folders.
#pragma once

#include <string>
#include <string_view>

namespace pointsweep {

/// Returns the pipeline with the absolute names of the files, folders and patterns that its options name. An option
/// that may be a text instead of a file stays unchanged if there is no such file. Throws UsageError like
/// parse_pipeline() and find_operator().
std::string with_absolute_files(std::string_view pipeline);

}  // namespace pointsweep
