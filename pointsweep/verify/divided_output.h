// SPDX-License-Identifier: MIT
/// The files among which a run has divided its output (RunOptions::division), read as one, and whether each of their
/// points is where it belongs.
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

/// Returns the division that the record of an output states; none where the output is not divided.
OutputDivision recorded_division(const ProvenanceRecord& record);

struct DividedOutput {
  std::unique_ptr<Reader> own;         ///< the points of all files but those of buffers, without the attribute `buffer`
  std::uint64_t misplaced = 0;         ///< points in the wrong file, and files with a wrong name or buffer
  std::vector<std::string> sentences;  ///< about the first few of them
};

/// Reads all files once. `folder`: what they are called together. `files` outlive the result only as far as their
/// readers go.
DividedOutput read_divided(const std::vector<std::filesystem::path>& files, const std::filesystem::path& folder,
                           const OutputDivision& division, const PhaseProgress& progress);

}  // namespace pointsweep
