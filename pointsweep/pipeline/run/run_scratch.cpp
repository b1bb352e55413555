// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/run/run_scratch.h"

#include "pointsweep/pipeline/spilled_scratch.h"

namespace pointsweep {

RunScratch::RunScratch(const RunState& run) {
  if (!run.folder) own_.emplace(temp_parent(run.options.resources.temp_folder));
  folder_ = run.folder ? &*run.folder : &*own_;
  make_ = [folder = folder_]() -> std::unique_ptr<Scratch> { return std::make_unique<SpilledScratch>(*folder); };
}

}  // namespace pointsweep
