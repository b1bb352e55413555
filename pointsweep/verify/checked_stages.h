// SPDX-License-Identifier: MIT
/// The stages of a run that `verify` can check, and the rows of the input on which it checks them; and the run that the
/// processing record of a file describes.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/formats/provenance.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/verify/verify.h"

namespace pointsweep {

/// Returns the newest record of a point file; none if the file is an array, has no record or a record without stages.
std::optional<ProvenanceRecord> recorded_run(const std::filesystem::path& file);

/// Returns the paths of the inputs of a recorded run, in their order. Looks for an input under its absolute path or URL
/// if the record states it, then in the folder of `file`, then in the current folder. Throws Error if an input is
/// missing or has another size, UsageError if the record does not name all inputs.
std::vector<std::filesystem::path> recorded_inputs(const ProvenanceRecord& record, const std::filesystem::path& file);

/// Returns the stages of a plan that can be checked: up to the first new neighbourhood or voxel(keep=centroid), without
/// stages that depend on all points after points have moved, and, after a select that follows other stages, without
/// stages that read neighbours. MadeBy::unchecked lists the attributes of the other stages. Selects at the beginning
/// are not included.
MadeBy made_by(const ChainPlan& plan);

/// Limits a check to the selects after other stages, so that it compares no made attribute.
void leave_selects(MadeBy& made);

/// Adds to `made` the fields that --keep has excluded from the output.
void leave_out(const KeptFields& named, const std::string& prefix, const Schema& input, MadeBy& made);

/// The rows of the input that stages have kept.
struct KeptRows {
  InputCloud cloud;                          ///< rows that the selects and thinnings at the beginning of the chain keep
  std::shared_ptr<InputCloud> before_means;  ///< rows before voxel(keep=centroid); null without such a stage
};

/// Returns the rows of `cloud` that the selects and thinnings at the beginning of the chain keep. Throws UsageError for
/// a thinning after other stages, and for any stage that drops rows after voxel(keep=centroid).
KeptRows rows_kept_first(const VerifyOptions& options, const InputCloud& cloud, const ChainGraph& graph);

}  // namespace pointsweep
