// SPDX-License-Identifier: MIT
/// Stages applied to points that have no neighbours.
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

/// Takes points without neighbours through the stages of a pass: all points of a pass over rows, and the points without
/// a finite place of any other pass. A stage that looks at its own point alone treats them as any other point. Every
/// other stage leaves them unchanged: the position, and an attribute that the stage reads of the point and makes again,
/// keep their values; what else it makes gets the value of none, Attribute::fill.
class PointwiseStages {
 public:
  /// `pass` is bound to `records` (PlannedPass::bind). Both must outlive this.
  PointwiseStages(const PlannedPass& pass, const Schema& records);

  /// Makes the result records of the points in `records`, whose rows are `rows`, on all threads.
  void run(const std::byte* records, std::span<const std::uint64_t> rows, std::byte* results);
  /// The times and the degenerate rows of all calls of run().
  StageTally tally() const;

 private:
  void run_batch(const std::byte* records, std::span<const std::uint64_t> rows, StageTally& tally,
                 std::byte* results) const;

  const PlannedPass& pass_;
  const Schema& records_;
  PositionFields position_;
  std::vector<StageTally> tallies_;  ///< by thread
};

/// Stages that look at nothing but their own point, applied to rows in their order, without a sweep.
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
