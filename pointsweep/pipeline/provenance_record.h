// SPDX-License-Identifier: MIT
/// What outputs say of the run that made them (formats/provenance.h).
#pragma once

#include <string>
#include <vector>

#include "pointsweep/formats/input_cloud.h"
#include "pointsweep/pipeline/engine_run.h"

namespace pointsweep {

/// What determines the result of a run.
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
/// The same of an output for one input of a run: it names that input and counts the others.
std::vector<std::string> provenance_of_tile(const InputCloud& input, TileNumber number, const RunRecord& run);

}  // namespace pointsweep
