// SPDX-License-Identifier: MIT
/// The sizes of the neighbourhoods, as attributes.
#pragma once

#include <string>

#include "pointsweep/operator.h"

namespace pointsweep {

/// Makes "neighbor_count", N u32: |N_i|, the point itself not counted; and "neighbor_radius", N f64: the distance to
/// the farthest neighbour, in length units, at the current positions; 0 without neighbours, NaN if a neighbour has no
/// finite place. The values show the choice of a rule of neighbourhoods, and both can be the limits of a later run
/// (PDAL stores them under the names OptimalKNN and OptimalRadius).
class NeighborhoodSize final : public LocalOperator {
 public:
  std::string name() const override { return "neighborhood_size"; }
  Contract contract() const override;
  void apply(const Neighborhoods& in, Columns& out) const override;
};

}  // namespace pointsweep
