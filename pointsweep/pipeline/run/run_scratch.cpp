// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/run/run_scratch.h"

#include "pointsweep/pipeline/memory/spilled_scratch.h"

namespace pointsweep {

const TempFolder& RunScratch::folder() {
  if (run_.folder) return *run_.folder;
  if (!own_) own_.emplace(temp_parent(run_.options.resources.temp_folder));
  return *own_;
}

MakeScratch RunScratch::make() {
  return [this]() -> std::unique_ptr<Scratch> { return std::make_unique<SpilledScratch>(folder()); };
}

}  // namespace pointsweep
