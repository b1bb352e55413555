// SPDX-License-Identifier: MIT
/// The number of a point's row in the inputs, for chains that read it.
#pragma once

#include <cstdint>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/pipeline/plan/chain_plan.h"

namespace pointsweep {

/// During its lifetime, the records of the cloud contain their row numbers if a stage of the plan reads them.
class NumberedInput {
 public:
  /// `first`: the number of the first row.
  NumberedInput(InputCloud& cloud, const ChainPlan& plan, std::uint64_t first = 0) : cloud_(cloud) {
    if (plan.graph.reads_input_rows()) cloud.number_rows(first);
  }
  ~NumberedInput() { cloud_.leave_unnumbered(); }
  NumberedInput(const NumberedInput&) = delete;
  NumberedInput& operator=(const NumberedInput&) = delete;

 private:
  InputCloud& cloud_;
};

}  // namespace pointsweep
