// SPDX-License-Identifier: MIT
/// Keeping one of the points that lie at one place.
#pragma once

#include <memory>
#include <string>

#include "pointsweep/operator.h"

namespace pointsweep {

struct OperatorDeclaration;

OperatorDeclaration unique_declaration();

/// Keeps, of all points with equal coordinates at their current positions, the one of the first row. Coordinates are
/// equal if all three are equal numbers (-0 and 0 are); points without a finite place are all kept. Needs no
/// neighbourhoods: the points are put in order once.
class Unique final : public Operator {
 public:
  std::string name() const override { return "unique"; }
  Contract contract() const override {
    return {.makes = {selection_attribute()},
            .alone = true,
            .selects = Selects::in_order,
            .arrival = "equal ones together"};
  }
  void apply(const Neighborhoods&, Columns&) const override {}
  std::unique_ptr<Thinning> thinning(const ThinningSetup&) const override;
};

}  // namespace pointsweep
