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

/// An edge between point i of a batch and one of its neighbours. `weight` and `flips` depend on the two points alone:
/// the neighbour, if it emits the edge too, computes the same bits.
struct NeighborEdge {
  std::uint32_t point;
  NeighborRef neighbor;
  double weight = 0;
  bool flips = false;  ///< true if the edge asks for different signs of the two points
};

/// An operator that emits edges. The values of a point follow from the component of the point and from its sign in the
/// minimum spanning forest, which are known at the end of the pass (docs/adr/0014). A pass has at most one
/// ConnectOperator.
class ConnectOperator : public Operator {
 public:
  /// Returns whether edges have weights and flips; otherwise all edges are equal. With weights, put_values() may read
  /// only the `flips` of a label.
  virtual bool weighted() const { return false; }
  /// Returns the rule by which the points of a component vote. If null, every component gets a number, and no signs are
  /// turned.
  virtual const VoteRule* votes() const { return nullptr; }
  /// Appends the edges of the points of the batch, at most one for each neighbour. Writes votes()->ballot_bytes() of
  /// each point to `ballots`, point after point. Called from many threads at once.
  virtual void connect(const Neighborhoods& in, std::vector<NeighborEdge>& edges, std::byte* ballots) const = 0;
  /// Writes the values of a point for all attributes that the operator makes, one after another.
  virtual void put_values(const ComponentLabel& label, std::byte* values) const = 0;
  /// Returns the operator for a cloud with the fields of `input` after stages that make `made`; see
  /// LocalOperator::bound().
  virtual std::shared_ptr<const ConnectOperator> bound(const Schema& input, std::span<const Attribute> made) const {
    (void)input, (void)made;
    return nullptr;
  }
};

}  // namespace pointsweep
