// SPDX-License-Identifier: MIT
/// The cloud of the files among which a run has divided its output (RunOptions::division), which checks that each point
/// is in the right file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/formats/provenance.h"
#include "pointsweep/run.h"
#include "pointsweep/verify/rows/row_source.h"

namespace pointsweep {

/// Returns the division that the record of an output states; none if the output is not divided.
OutputDivision recorded_division(const ProvenanceRecord& record);

struct Misplaced {
  std::uint64_t count = 0;  ///< number of points in the wrong file, and of files with a wrong name or buffer
  std::vector<std::string> sentences = {};  ///< messages about the first few of them
};

struct DividedOutput {
  InputCloud own;  ///< points of all files, without points of buffers
  Misplaced misplaced;
};

/// The attribute that tells the points of a buffer from those of the tile.
inline constexpr const char* kBuffer = "buffer";

/// Reads all files once.
DividedOutput read_divided(const std::vector<std::filesystem::path>& files, const OutputDivision& division,
                           const PhaseProgress& progress);

}  // namespace pointsweep
