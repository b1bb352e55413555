// SPDX-License-Identifier: MIT
/// A pass that takes all points in order, to an InOrderOperator.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pointsweep/in_order_operator.h"
#include "pointsweep/order/row_store.h"
#include "pointsweep/order/source.h"
#include "pointsweep/order/stream.h"
#include "pointsweep/pipeline/plan/chain_plan.h"

namespace pointsweep {

/// The points of `source` at the places that `op` gives them. Each place is followed by the position, in its type, and
/// by the fields `payload` of the source. A point without a finite position has no place. `op` must outlive the source.
struct PlacedSource {
  PlacedSource(const PointSource& source, const std::vector<std::size_t>& payload, const InOrderOperator& op);
  PointSource source;
  std::vector<std::size_t> payload;  ///< indices of the fields that follow a place
};

struct InOrderPass {
  const Stream& stream;  ///< canonical; of a PlacedSource if the pass has places
  const PlannedPass& pass;
  InOrderSetup setup;
  bool is_part;              ///< the stream has other rows, too, whose findings are not kept
  std::uint64_t first_row;   ///< of the stream, which is the first row of the results
  std::uint64_t rows;        ///< of the results
  RowStore& results;         ///< gets a record for each row that is dropped or has values, and nothing for the others
  std::uint64_t* undecided;  ///< gets the number of rows of the results that are undecided; null: none can be
  std::function<void(std::uint64_t points)> progress;
};

/// Returns the numbers of those of some working records of the pass, at their positions and all with a finite one, that
/// other parts of a cloud have to know. Throws the error of a row that has a value which the stage cannot read.
std::vector<std::uint32_t> for_other_parts(const InOrderOperator::ChoosePoints& choose, const PlannedPass& pass,
                                           const Schema& record, std::span<const std::byte> records);

/// Takes all points with a finite place through the work of the operator.
void run_in_order(const InOrderPass& run);

}  // namespace pointsweep
