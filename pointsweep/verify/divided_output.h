// SPDX-License-Identifier: MIT
/// A reader of the files among which a run has divided its output (RunOptions::division), which checks that each point
/// is in the right file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pointsweep/formats/provenance.h"
#include "pointsweep/reader.h"
#include "pointsweep/run.h"
#include "pointsweep/verify/rows/row_source.h"

namespace pointsweep {

/// Returns the division that the record of an output states; none if the output is not divided.
OutputDivision recorded_division(const ProvenanceRecord& record);

struct DividedOutput {
  std::unique_ptr<Reader> own;  ///< points of all files, without points of buffers and without the attribute `buffer`
  std::uint64_t misplaced = 0;  ///< number of points in the wrong file, and of files with a wrong name or buffer
  std::vector<std::string> sentences;  ///< messages about the first few misplaced points and wrong files
};

/// Reads all files once. `folder`: the name of all files together in messages.
DividedOutput read_divided(const std::vector<std::filesystem::path>& files, const std::filesystem::path& folder,
                           const OutputDivision& division, const PhaseProgress& progress);

}  // namespace pointsweep
