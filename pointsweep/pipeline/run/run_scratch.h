// SPDX-License-Identifier: MIT
/// The places for data of a pass that no later pass needs. The files have no names in the folder, so that a resumed run
/// does not find them.
#pragma once

#include <optional>

#include "pointsweep/order/temp_folder.h"
#include "pointsweep/pipeline/run/run_state.h"
#include "pointsweep/points/scratch.h"

namespace pointsweep {

class RunScratch {
 public:
  explicit RunScratch(const RunState& run) : run_(run) {}
  /// The temporary folder of the run. If the run has none, the first call makes one.
  const TempFolder& folder();
  /// Makes files in folder(). *this must outlive the function.
  MakeScratch make();

 private:
  const RunState& run_;
  std::optional<TempFolder> own_;
};

}  // namespace pointsweep
