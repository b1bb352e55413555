// SPDX-License-Identifier: MIT
/// Operators whose values come from the components of a graph of neighbours.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "pointsweep/connect/forest_log.h"
#include "pointsweep/connect/vote_rule.h"
#include "pointsweep/operator.h"

namespace pointsweep {

/// An edge between point i of a batch and one of its neighbours. Weight and parity are functions of the two points: the
/// neighbour, if it emits the edge too, gives them the same bits.
struct NeighborEdge {
  std::uint32_t point;
  NeighborRef neighbor;
  double weight = 0;
  bool flips = false;  ///< the signs of the two differ
};

/// A stage that emits edges. Its attributes are known at the end of its pass: for each point they follow from its
/// component, and from its sign in the minimum spanning forest (docs/adr/0014). It is the only such stage in its pass.
class ConnectOperator : public Operator {
 public:
  /// Returns whether edges have weights and parities; otherwise all edges are equal. With weights, put_values() may read
  /// only the `flips` of a label.
  virtual bool weighted() const { return false; }
  /// Returns the rule of votes of components; null: every component counts, and no signs are flipped.
  virtual const VoteRule* votes() const { return nullptr; }
  /// Appends edges of the points of the batch, which may be fewer than one for each neighbour, and fills ballots,
  /// votes()->ballot_bytes() for each point. Called from many threads at once.
  virtual void connect(const Neighborhoods& in, std::vector<NeighborEdge>& edges, std::byte* ballots) const = 0;
  /// Sets the values of all attributes that the operator makes of a point, one after another.
  virtual void put_values(const ComponentLabel& label, std::byte* values) const = 0;
  /// Returns the operator for such a cloud; see LocalOperator::bound().
  virtual std::shared_ptr<const ConnectOperator> bound(const Schema& input, std::span<const Attribute> made) const {
    (void)input, (void)made;
    return nullptr;
  }
};

}  // namespace pointsweep
