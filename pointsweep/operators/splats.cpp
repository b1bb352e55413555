// SPDX-License-Identifier: MIT
#include "pointsweep/operators/splats.h"

#include "pointsweep/operators/curvature.h"
#include "pointsweep/operators/splats_kernel.h"
#include "pointsweep/operators/tangent_plane.h"

namespace pointsweep {
Attribute splat_axis_attribute() {
  return {
      "splat_axis", Type::f32, Kind::vector, {"splat_x", "splat_y", "splat_z"}, "1", "unit major axis of the splat"};
}
Attribute splat_length_attribute() {
  return scalar("splat_length", Type::f32, "length", "major semi-axis of the splat");
}
Attribute splat_ratio_attribute() {
  return scalar("splat_ratio", Type::f32, "1", "minor over major semi-axis of the splat, in [1/8, 1]; 0: none");
}

Contract Splats::contract() const {
  Contract c;
  c.reads = {normal_attribute()};
  if (options_.axes == SplatAxes::curvature)
    c.reads.insert(c.reads.end(), {k1_direction_attribute(), k1_attribute(), k2_attribute()});
  c.makes = {splat_axis_attribute(), splat_length_attribute(), splat_ratio_attribute()};
  return c;
}

void Splats::apply(const Neighborhoods& in, Columns& out) const {
  fit_splats(in, options_.axes == SplatAxes::curvature,
             {.axis = out.column<Float3>(0), .length = out.column<float>(1), .ratio = out.column<float>(2)},
             out.degenerate());
}

}  // namespace pointsweep
