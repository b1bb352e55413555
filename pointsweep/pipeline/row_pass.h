// SPDX-License-Identifier: MIT
/// Stages that look at nothing but their own point, applied to rows in their order, without a sweep.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pointsweep/order/source.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/sweep/stage_runner.h"

namespace pointsweep {

class RowPass {
 public:
  /// `pass`: of kind rows, bound to its own input (PlannedPass::bind). It must outlive this.
  explicit RowPass(const PlannedPass& pass);

  /// Reads `source`, records of pass.input, and gives the result records of its rows in their order, those of at most a
  /// megabyte of input at once. On all threads.
  void run(const PointSource& source,
           const std::function<void(std::uint64_t first_row, std::size_t count, const std::byte* results)>& use);
  const StageTally& tally() const { return tally_; }

 private:
  void run_batch(const std::byte* records, std::uint64_t first_row, std::size_t size, StageTally& tally,
                 std::byte* results) const;
  void give_none(const PositionFields& position, const std::byte* record, std::byte* result) const;

  const PlannedPass& pass_;
  PositionFields position_;
  StageTally tally_;
};

}  // namespace pointsweep
