// SPDX-License-Identifier: MIT
/// A chain cut into passes over the cloud. A pass ends where a later stage needs what only its end can tell: the
/// neighbours of moved points, neighbours among the rows that were kept, or a value of the whole cloud
/// (docs/adr/0006, docs/adr/0009).
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "pointsweep/operators/reduction.h"
#include "pointsweep/pipeline/chain.h"

namespace pointsweep {

enum class PassKind : std::uint8_t {
  sweep,  ///< finds neighbourhoods
  rows,   ///< reads the rows in their order: its stages look at their own point only
  order,  ///< puts the points in canonical order, in which equal ones are adjacent
};

/// A value of the cloud that is known when a pass has ended, of the rows it leaves.
struct PlannedValue {
  std::shared_ptr<const Reduction> reduction;
  std::size_t number;  ///< among those of the whole chain
};

/// One pass. To it the cloud is a file with what earlier passes made in the place of what the input has.
struct PlannedSweep {
  PassKind kind = PassKind::sweep;
  /// Its stages; a select makes selection_attribute() beside what is kept.
  PlannedChain chain;
  /// The fields of that file: those of the input's record, behind which the values carried from the pass before follow.
  Schema input;
  /// What the rows hold when it has ended, whichever sweep made it: what later passes read and what is kept.
  std::vector<Attribute> carried;
  bool selects = false;  ///< of the rows it reads, it leaves some out
  std::vector<PlannedValue> values;
  /// By stage, the numbers of the values it is to be given.
  std::vector<std::vector<std::size_t>> values_of_stages;
};

struct PlannedSweeps {
  std::vector<PlannedSweep> sweeps;  ///< at least one
  /// The last version of every attribute made and kept, in the order first made.
  std::vector<Attribute> made;
  /// What of these and of the input is written.
  KeptFields kept;
  /// Order::sweep asks for an order that is not the one of the (only) sweep.
  bool reorders = false;
  /// That order is the one of stream_position_attribute(), the last of what the last pass carries; otherwise the
  /// input's.
  bool by_moved_positions = false;

  bool selects() const;
};

/// The position a point had at the last Resort of the chain; made only where the order of the output needs it.
Attribute stream_position_attribute();

/// The operators of a chain that are no composites, bound to the input.
std::vector<std::shared_ptr<const Operator>> flattened(const std::vector<std::shared_ptr<const Operator>>& operators,
                                                       const Schema& input);

/// Throws as plan_chain(), and UsageError where nothing is made and all rows are kept. As few passes as the chain
/// allows: stages run in the first pass in which all they read is there, and a pass without results that are used is
/// left out. `ordered`: the output is to be in stream order.
PlannedSweeps plan_sweeps(const Chain& chain, const Schema& input, bool ordered = false);

/// `input` with the values of `carried`, which follow its record one after another, instead of its fields of the same
/// names.
Schema with_carried(const Schema& input, const std::vector<Attribute>& carried);

}  // namespace pointsweep
