// SPDX-License-Identifier: MIT
/// Inputs that read only some nodes of levels of detail, for chains that begin by cutting out a region.
#pragma once

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/pipeline/plan/chain_plan.h"

namespace pointsweep {

/// During its lifetime, the cloud reads no node of levels of detail whose box lies outside of the region that the first
/// stages of the plan keep (SelectOperator::extent()). The boxes of nodes of COPC files are trusted; boxes of other
/// chunks are not. If a stage of the chain reads row numbers, all nodes are read.
class CroppedInput {
 public:
  CroppedInput(InputCloud& cloud, const ChainPlan& plan);
  ~CroppedInput() { cloud_.read_all_chunks(); }
  CroppedInput(const CroppedInput&) = delete;
  CroppedInput& operator=(const CroppedInput&) = delete;

 private:
  InputCloud& cloud_;
};

}  // namespace pointsweep
