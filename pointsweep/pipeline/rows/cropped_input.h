// SPDX-License-Identifier: MIT
/// Inputs of which a chain that begins by cutting out a region reads the nodes of that region alone.
#pragma once

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/pipeline/plan/chain_plan.h"

namespace pointsweep {

/// While it lives, the cloud reads no node of levels of detail whose box lies outside the region that the first stages
/// of the plan keep (SelectOperator::extent()). So the nodes of a COPC file are believed to hold their points; boxes of
/// other chunks are not. A chain that reads the numbers of rows reads all of them.
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
