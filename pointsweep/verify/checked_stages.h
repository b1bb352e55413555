// SPDX-License-Identifier: MIT
/// The stages of a run that `verify` can check, and the rows of the input on which it checks them; the run that
/// made a file, as the file itself says.
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

/// The newest record of a point file; nothing for files without one and for arrays.
std::optional<ProvenanceRecord> recorded_run(const std::filesystem::path& file);

/// The inputs of the run in their order: each under its absolute path if the record has that, else in the folder of
/// `file` or in the current folder. Throws Error where one is missing or has another size, UsageError where the record
/// does not name all of them.
std::vector<std::filesystem::path> recorded_inputs(const ProvenanceRecord& record, const std::filesystem::path& file);

/// Returns what the stages of a plan make, as far as the input can tell: up to the first new neighbourhood, and not
/// from all points of a cloud that has moved. The selects at the beginning are not among them.
MadeBy made_by(const ChainPlan& plan);

/// Keeps the selects alone among the operators, for a check that compares no made attribute.
void leave_selects(MadeBy& made);

/// Notes in `made` the fields that --keep has left out of the output.
void leave_out(const KeptFields& named, const std::string& prefix, const Schema& input, MadeBy& made);

/// Selects the rows that the first stages keep. With voxel(keep=centroid) after these, returns the cloud before it,
/// which `open_again` opens. Throws UsageError for a thinning after other stages, and
/// for any select after these means.
std::shared_ptr<InputCloud> select_rows(const VerifyOptions& options, InputCloud& cloud, const ChainGraph& graph,
                                        const std::function<std::shared_ptr<InputCloud>()>& open_again);

}  // namespace pointsweep
