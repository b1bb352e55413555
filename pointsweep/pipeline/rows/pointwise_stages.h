// SPDX-License-Identifier: MIT
/// Application of the stages of a pass to points without their neighbours.
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

/// Applies the stages of a pass to points without neighbours: all points of a pass over rows, and the points without a
/// finite place of any other pass. A stage that reads only the point itself treats them like any other point. Other
/// stages leave them unchanged: the position, and attributes of which the stage reads all fields and which it makes
/// again, keep their values; each byte of other made attributes is Attribute::fill.
class PointwiseStages {
 public:
  /// `pass` is bound to `records` (PlannedPass::bind). Both must outlive this object.
  PointwiseStages(const PlannedPass& pass, const Schema& records);

  /// Makes the result records of the points in `records`, whose rows are `rows`, on all threads. Throws the error of
  /// the lowest row with an error.
  void run(const std::byte* records, std::span<const std::uint64_t> rows, std::byte* results);
  /// Returns the times and the degenerate rows of all calls of run().
  StageTally tally() const;

 private:
  void run_batch(const std::byte* records, std::span<const std::uint64_t> rows, StageTally& tally,
                 std::byte* results) const;

  const PlannedPass& pass_;
  const Schema& records_;
  PositionFields position_;
  std::vector<StageTally> tallies_;  ///< one tally for each thread
};

/// Applies the stages of a pass of kind rows, which is bound to its own input (PlannedPass::bind), to rows in their
/// order, without a sweep. Reads `source`, records of pass.input, and passes on the result records of its rows,
/// rows_at_once() at a time. Reads ahead if several threads can read the source. Works on all threads. Returns the
/// times and the degenerate rows.
StageTally run_rows(
    const PlannedPass& pass, const PointSource& source,
    const std::function<void(std::uint64_t first_row, std::size_t count, const std::byte* results)>& use);

}  // namespace pointsweep
