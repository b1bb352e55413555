// SPDX-License-Identifier: MIT
/// The update operators that the paper asks for after points have moved (Section 8: "new sort-update and
/// k-nearest-update stream operators that are inserted after such coordinate-manipulating operations"). They compute
/// nothing for a point: they tell the planner where a new sweep begins and how the output is ordered.
#pragma once

#include <memory>
#include <utility>

#include "pointsweep/points/neighborhood.h"

namespace pointsweep {

struct OperatorDeclaration;

/// The stages behind it have the neighbourhoods of the current positions, exact and certified like the first ones: they
/// make what they would make of a file that holds these positions in float64 and everything made so far. Points that a
/// mover has taken to a place that is not finite have no neighbours from here on.
///
/// Without it, neighbourhoods stay those of the positions before, wherever the points go. Cost: one more sweep, and
/// between the two one temporary record for each point, of the positions and of what is still needed.
struct Reneighbor {
  /// The previous definition of a neighbourhood applies.
  Reneighbor() = default;
  explicit Reneighbor(Neighborhood next) : neighborhood(std::make_shared<const Neighborhood>(std::move(next))) {}
  std::shared_ptr<const Neighborhood> neighborhood;  ///< null: the previous one
};

/// With Order::sweep the output has its rows in canonical order of the current positions, along the axis of their
/// largest extent unless one is chosen, exactly as sort() of a file that holds these positions in float64. Without it
/// that order is the one of the input's positions, also after Reneighbor. An order never changes a value:
/// neighbourhoods stay the same, and with Order::input it is a no-op. The last one in a chain counts. Cost: none in the
/// sweep, one more ordering of the output.
struct Resort {};

OperatorDeclaration reneighbor_declaration();
OperatorDeclaration resort_declaration();

}  // namespace pointsweep
