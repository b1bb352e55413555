// SPDX-License-Identifier: MIT
#include "pointsweep/operators/neighborhood_size.h"

#include <cmath>
#include <span>

namespace pointsweep {

Contract NeighborhoodSize::contract() const {
  return {{},
          {},
          {scalar("neighbor_count", Type::u32, "1", "number of neighbours"),
           scalar("neighbor_radius", Type::f64, "length", "distance to the farthest neighbour; 0 without any")}};
}

void NeighborhoodSize::apply(const Neighborhoods& in, Columns& out) const {
  const std::span<std::uint32_t> count = out.column<std::uint32_t>(0);
  const std::span<double> radius = out.column<double>(1);
  for (std::size_t i = 0; i < in.size(); ++i) {
    count[i] = static_cast<std::uint32_t>(in.count(i));
    radius[i] = std::sqrt(in.farthest_distance2(i));
  }
}

}  // namespace pointsweep
