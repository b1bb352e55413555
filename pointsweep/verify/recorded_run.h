// SPDX-License-Identifier: MIT
/// The run that made a file, as the file itself says, and where its inputs are now.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "pointsweep/formats/provenance.h"

namespace pointsweep {

/// The newest record of a point file; nothing for files without one and for arrays.
std::optional<ProvenanceRecord> recorded_run(const std::filesystem::path& file);

/// The inputs of the run in their order: each under its absolute path if the record has that, else in the folder of
/// `file` or in the current folder. Throws Error where one is missing or has another size, UsageError where the record
/// does not name all of them.
std::vector<std::filesystem::path> recorded_inputs(const ProvenanceRecord& record, const std::filesystem::path& file);

}  // namespace pointsweep
