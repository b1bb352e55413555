// SPDX-License-Identifier: MIT
/// Keeping one of several points that lie at one place.
#pragma once

#include <memory>
#include <string>

#include "pointsweep/in_order_operator.h"

namespace pointsweep {

/// Keeps one of the points with equal current coordinates: the one with the lowest row. Coordinates are equal if all
/// three are equal numbers (-0 and 0 are); points without a finite place are all kept. Needs no neighbourhoods: the
/// points are put in order once.
class Unique final : public InOrderOperator {
 public:
  std::string name() const override { return "unique"; }
  InOrderContract in_order_contract() const override { return {.drops_rows = true, .arrival = "equal ones together"}; }
  std::unique_ptr<InOrderWork> start(const InOrderSetup&) const override;
  std::optional<Reach> reach() const override { return Reach{}; }
};

}  // namespace pointsweep
