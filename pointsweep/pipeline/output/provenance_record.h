// SPDX-License-Identifier: MIT
/// The record of a run that its outputs hold (formats/provenance.h).
#pragma once

#include <string>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/pipeline/engine_run.h"

namespace pointsweep {

/// The facts that determine the result of a run, for its processing record.
struct RunRecord {
  std::vector<std::string> stages;  ///< canonical_stages() with presets left out, or {"sort"}
  std::vector<std::string> keep;    ///< Chain::keep if it leaves anything out
  const EngineOptions& options;
  int axis = 0;  ///< of the sweep
  bool drops_nonfinite = false;
};

/// All that an output of this run is to say: the records of the inputs, and with RunOptions::provenance that of the
/// run.
std::vector<std::string> provenance_of(const InputCloud& cloud, const RunRecord& run);

struct TileNumber {
  std::size_t tile = 0, tiles = 0;  ///< the first is 0
};
/// Returns the record for a tile, the output for one input of a run. It names that input and counts the others.
std::vector<std::string> provenance_of_tile(const InputCloud& input, TileNumber number, const RunRecord& run);

}  // namespace pointsweep
