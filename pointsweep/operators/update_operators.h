// SPDX-License-Identifier: MIT
/// The update operators that the paper asks for after points have moved (Section 8: "new sort-update and
/// k-nearest-update stream operators that are inserted after such coordinate-manipulating operations").
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "pointsweep/operators/operator.h"
#include "pointsweep/points/neighborhood.h"

namespace pointsweep {

/// Neighbourhoods from here on are those of the positions as they are now, exact and certified like the first ones: the
/// stages behind it make what they would make of a file that holds these positions in float64 and everything made so
/// far. Points that a mover has taken to a place that is not finite have no neighbours from here on.
///
/// Without it, neighbourhoods stay those of the positions before, wherever the points go. It makes nothing and does
/// nothing to a cell: the planner ends a sweep here and begins another one. Cost: one more sweep, and between the two
/// one temporary record for each point, of the positions and of what is still needed.
class Reneighbor final : public Operator {
 public:
  /// `neighborhood` absent: what a neighbourhood is stays as it was.
  explicit Reneighbor(std::optional<Neighborhood> neighborhood = std::nullopt)
      : neighborhood_(std::move(neighborhood)) {}
  std::string name() const override { return "reneighbor"; }
  Contract contract() const override { return {}; }
  void apply(const Neighborhoods&, Columns&) const override {}
  const std::optional<Neighborhood>& neighborhood() const { return neighborhood_; }

 private:
  Options own_options() const override { return neighborhood_ ? neighborhood_->options() : Options(); }
  std::optional<Neighborhood> neighborhood_;
};

/// The stream order from here on is that of the positions as they are now: with Order::sweep the output has its rows in
/// canonical order of them, along the axis where they reach farthest unless one is chosen, exactly as sort() of a file
/// that holds these positions in float64. Without it that order is the one of the input's positions, also after
/// Reneighbor. An order never changes a value: neighbourhoods stay as they are, and with Order::input nothing happens.
/// The last one in a chain counts. Cost: none in the sweep, one more ordering of the output.
class Resort final : public Operator {
 public:
  std::string name() const override { return "resort"; }
  Contract contract() const override { return {}; }
  void apply(const Neighborhoods&, Columns&) const override {}
};

OperatorDeclaration reneighbor_declaration();
OperatorDeclaration resort_declaration();

}  // namespace pointsweep
