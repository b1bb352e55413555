// SPDX-License-Identifier: MIT
/// A chain cut into sweeps: where points move without limit, no sweep over the old positions can certify neighbourhoods
/// of the new ones, so each Reneighbor ends a sweep (docs/adr/0006).
#pragma once

#include <vector>

#include "pointsweep/pipeline/chain.h"

namespace pointsweep {

/// One sweep of a chain. To it the cloud is a file with what earlier sweeps made in the place of what the input has.
struct PlannedSweep {
  PlannedChain chain;
  /// The fields of that file: those of the input's record, behind which the values carried from the sweep before
  /// follow.
  Schema input;
  /// What the rows hold when it has ended, whoever made it: what later sweeps read and what is kept.
  std::vector<Attribute> carried;
};

struct PlannedSweeps {
  std::vector<PlannedSweep> sweeps;  ///< at least one
  /// The last version of every attribute made and kept, in the order first made.
  std::vector<Attribute> made;
  /// What of these and of the input is written.
  KeptFields kept;
  /// Order::sweep asks for an order that is not the one of the (only) sweep.
  bool reorders = false;
  /// That order is the one of stream_position_attribute(), the last of what the last sweep carries; otherwise the
  /// input's.
  bool by_moved_positions = false;
};

/// The position a point had at the last Resort of the chain; made only where the order of the output needs it.
Attribute stream_position_attribute();

/// Throws as plan_chain(), and UsageError where nothing is made. A sweep whose results nobody needs is left out.
/// `ordered`: the output is to be in stream order.
PlannedSweeps plan_sweeps(const Chain& chain, const Schema& input, bool ordered = false);

/// `input` with the values of `carried`, which follow its record one after another, instead of its fields of the same
/// names.
Schema with_carried(const Schema& input, const std::vector<Attribute>& carried);

}  // namespace pointsweep
