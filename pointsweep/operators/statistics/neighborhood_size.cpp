// SPDX-License-Identifier: MIT
/// The sizes of the neighbourhoods, as attributes.
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "pointsweep/operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"

namespace pointsweep {
namespace {

/// Makes "neighbor_count", N u32: |N_i|, the point itself not counted; and "neighbor_radius", N f64: the distance to
/// the farthest neighbour, in length units, at the current positions; 0 without neighbours, NaN if a neighbour has no
/// finite place. The values show the choice of a rule of neighbourhoods, and both can be the limits of a later run
/// (PDAL stores them under the names OptimalKNN and OptimalRadius).
class NeighborhoodSize final : public LocalOperator {
 public:
  std::string name() const override { return "neighborhood_size"; }
  Contract contract() const override {
    return {{},
            {},
            {scalar("neighbor_count", Type::u32, "1", "number of neighbours"),
             scalar("neighbor_radius", Type::f64, "length", "distance to the farthest neighbour; 0 without any")}};
  }
  void apply(const Neighborhoods& in, Columns& out) const override {
    const std::span<std::uint32_t> count = out.column<std::uint32_t>(0);
    const std::span<double> radius = out.column<double>(1);
    for (std::size_t i = 0; i < in.size(); ++i) {
      count[i] = static_cast<std::uint32_t>(in.count(i));
      radius[i] = std::sqrt(in.farthest_distance2(i));
    }
  }
};

}  // namespace

OperatorDeclaration neighborhood_size_declaration() {
  return {.name = "neighborhood_size",
          .meaning = "number of neighbours and distance of the farthest",
          .make = [](const OptionValues&, const Facts&) { return std::make_shared<NeighborhoodSize>(); },
          .formula = "|N_i| without p_i, and max_j |p_j - p_i|",
          .source = "PDAL keeps the same as OptimalKNN and OptimalRadius",
          .attributes = {{.name = "neighbor_count", .meaning = "how many neighbours the point has"},
                         {.name = "neighbor_radius",
                          .meaning = "distance to the farthest of them at the positions the stage sees; without any: "
                                     "0; if one has no finite place: NaN"}},
          .example = "knn(radius=0.1) | neighborhood_size"};
}

ChainStage operators::neighborhood_size() { return std::make_shared<NeighborhoodSize>(); }

}  // namespace pointsweep
