// SPDX-License-Identifier: MIT
/// The output of a run that has divided it among files (RunOptions::division), read as one cloud, and a check that each
/// point is in the right file.
#pragma once

#include <filesystem>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/formats/provenance.h"
#include "pointsweep/run.h"
#include "pointsweep/verify/rows/row_source.h"
#include "pointsweep/verify/verify.h"

namespace pointsweep {

/// Returns the division that the record of an output states; none if the output is not divided.
OutputDivision recorded_division(const ProvenanceRecord& record);

struct DividedOutput {
  InputCloud own;         ///< points of all files, without points of buffers
  Differences misplaced;  ///< points in the wrong file, and files with a wrong name or buffer
};

/// The name of the attribute that is 0 for points of a tile and another number for points of its buffer.
inline constexpr const char* kBuffer = "buffer";

/// Returns the points of a divided output, and the faults of the division. Reads all files once.
DividedOutput read_divided(const std::vector<std::filesystem::path>& files, const OutputDivision& division,
                           const PhaseProgress& progress);

}  // namespace pointsweep
