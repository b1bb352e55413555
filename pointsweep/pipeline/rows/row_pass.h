// SPDX-License-Identifier: MIT
/// Stages that look at nothing but their own point, applied to rows in their order, without a sweep.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "pointsweep/order/source.h"
#include "pointsweep/pipeline/rows/pointwise_stages.h"

namespace pointsweep {

class RowPass {
 public:
  /// `pass`: of kind rows, bound to its own input (PlannedPass::bind). It must outlive this.
  explicit RowPass(const PlannedPass& pass);

  /// Reads `source`, records of pass.input, and gives the result records of its rows in their order, those of
  /// rows_at_once() at once. Reads ahead where several threads can read the source. On all threads.
  void run(const PointSource& source,
           const std::function<void(std::uint64_t first_row, std::size_t count, const std::byte* results)>& use);
  StageTally tally() const { return stages_.tally(); }

 private:
  const PlannedPass& pass_;
  PointwiseStages stages_;
};

}  // namespace pointsweep
