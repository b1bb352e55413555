// SPDX-License-Identifier: MIT
/// A pass that gives all points in order to an InOrderOperator (in_order_operator.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/in_order_operator.h"
#include "pointsweep/order/row_store.h"
#include "pointsweep/order/source.h"
#include "pointsweep/order/stream.h"
#include "pointsweep/pipeline/plan/chain_plan.h"

namespace pointsweep {

/// The points of a source at the places that an operator assigns to them (InOrderOperator::place_of()).
struct PlacedSource {
  /// The records of the member `source` begin with the place, as three numbers of type f64. The position follows, in
  /// the types of the argument `source`, then the fields with the indices `payload` of that argument. A point without a
  /// finite position has this position as its place. `op` must outlive the member `source`.
  PlacedSource(const PointSource& source, const std::vector<std::size_t>& payload, const InOrderOperator& op);
  PointSource source;
  std::vector<std::size_t> payload;  ///< indices of the fields that follow a place
};

struct InOrderPass {
  const Stream& stream;  ///< in canonical order; made from a PlacedSource if PlannedPass::has_places()
  const PlannedPass& pass;
  InOrderSetup setup;
  bool is_part;              ///< true for one tile: findings about other rows of the stream are discarded
  std::uint64_t first_row;   ///< row of the stream that is the first row of the results
  std::uint64_t rows;        ///< number of rows of the results
  RowStore& results;         ///< gets a record for each row that is dropped or has values; other rows keep their fill
  std::uint64_t* undecided;  ///< if `is_part`, the number of undecided rows of the tile is added to it; may be null
  std::function<void(std::uint64_t points)> progress;
};

/// Returns the indices of the working records that tasks for other tiles need for this pass, as `choose` decides. The
/// positions of all `records` must be finite. Throws the error of a row with a value that the stage cannot read.
std::vector<std::uint32_t> for_other_parts(const InOrderOperator::ChoosePoints& choose, const PlannedPass& pass,
                                           const Schema& record, std::span<const std::byte> records);

/// Passes all points with a finite place to a new InOrderWork of the operator, once in each round of this work, and
/// stores the findings of the work in `run.results`. Returns InOrderWork::warning(). Throws the error of the lowest row
/// of the results with a value that the stage cannot read.
std::string run_in_order(const InOrderPass& run);

}  // namespace pointsweep
