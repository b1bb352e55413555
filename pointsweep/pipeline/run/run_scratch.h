// SPDX-License-Identifier: MIT
/// Where a pass puts things aside that no later pass needs. They have no names in the folder, so that a run that is
/// resumed does not find them.
#pragma once

#include <optional>

#include "pointsweep/order/temp_folder.h"
#include "pointsweep/pipeline/run/run_state.h"
#include "pointsweep/points/scratch.h"

namespace pointsweep {

class RunScratch {
 public:
  /// Uses the temporary folder of the run, or makes one if the run has none.
  explicit RunScratch(const RunState& run);
  const TempFolder& folder() const { return *folder_; }
  const MakeScratch& make() const { return make_; }

 private:
  std::optional<TempFolder> own_;
  const TempFolder* folder_;
  MakeScratch make_;
};

}  // namespace pointsweep
