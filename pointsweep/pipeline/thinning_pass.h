// SPDX-License-Identifier: MIT
/// A pass that takes all points in order: to a Thinning, which decides which rows stay, or to an OrderedWork, which
/// makes an attribute.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "pointsweep/operators/ordered_operator.h"
#include "pointsweep/order/row_store.h"
#include "pointsweep/order/source.h"
#include "pointsweep/order/stream.h"
#include "pointsweep/pipeline/plan/chain_plan.h"

namespace pointsweep {

/// The points of `source` at the places that `op` gives them. Behind a place follow the position, in its type, and the
/// fields `payload` of the source. A point without a finite position has no place. `op` must outlive the source.
struct PlacedSource {
  PlacedSource(const PointSource& source, const std::vector<std::size_t>& payload, const Operator& op);
  PointSource source;
  std::vector<std::size_t> payload;  ///< indices of the fields that follow a place
};

struct ThinningPass {
  const Stream& stream;  ///< canonical; of a PlacedSource if the pass has places
  const PlannedPass& pass;
  std::uint64_t memory_bytes;  ///< for the Thinning, or the OrderedWork
  RowStore& results;           ///< gets zeros for each row that is left out, and nothing for the others
  std::function<void(std::uint64_t points)> progress;
};

/// Points that a Thinning or an OrderedWork gets at once, at most.
inline constexpr std::size_t kThinningBatch = 4096;

void run_thinning(const ThinningPass& run);

/// The same of an OrderedOperator: `results` gets the values that its work makes, as far as the pass keeps them.
void run_ordered_work(const ThinningPass& run, const OrderedOperator& op, const MakeScratch& make_scratch,
                      const OtherPoints& other_points);

}  // namespace pointsweep
