// SPDX-License-Identifier: MIT
#include "pointsweep/operators/curvature.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "pointsweep/math/saturated_float.h"
#include "pointsweep/operators/curvature_kernel.h"
#include "pointsweep/operators/tangent_plane.h"

namespace pointsweep {
Attribute k1_attribute() { return scalar("k1", Type::f32, "1/length", "larger principal curvature, without sign"); }
Attribute k2_attribute() { return scalar("k2", Type::f32, "1/length", "smaller principal curvature, without sign"); }
Attribute k1_direction_attribute() {
  return {"k1_direction", Type::f32, Kind::vector, {"k1_x", "k1_y", "k1_z"}, "1", "unit tangent along which k1 is"};
}

Contract Curvature::contract() const {
  return {{normal_attribute()},
          {normal_attribute()},
          {k1_attribute(),
           k2_attribute(),
           k1_direction_attribute(),
           scalar("mean_curvature", Type::f32, "1/length", "(k1 + k2) / 2, without sign"),
           scalar("gaussian_curvature", Type::f32, "1/length^2", "k1 k2, without sign"),
           scalar("rms_curvature", Type::f32, "1/length", "square root of (k1^2 + k2^2) / 2"),
           scalar("absolute_curvature", Type::f32, "1/length", "k1 + k2"),
           scalar("surface_variation", Type::f32, "1", "smallest eigenvalue of M_i over the sum of all, [0, 1/3]"),
           {"normal_eigenvalues",
            Type::f32,
            Kind::scalar,
            {"normal_eigenvalue_0", "normal_eigenvalue_1", "normal_eigenvalue_2"},
            "1",
            "eigenvalues of C_i, ascending"}}};
}

void Curvature::apply(const Neighborhoods& in, Columns& out) const {
  const std::span<float> k1 = out.column<float>(0), k2 = out.column<float>(1);
  const std::span<Float3> direction = out.column<Float3>(2);
  const std::span<float> mean = out.column<float>(3), gaussian = out.column<float>(4), rms = out.column<float>(5),
                         absolute = out.column<float>(6), variation = out.column<float>(7);
  const std::span<Float3> eigenvalues = out.column<Float3>(8);
  std::array<PointCurvature, 64> found;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const std::size_t c = i % found.size();
    if (c == 0) curvatures(in, i, std::span(found).first(std::min(found.size(), in.size() - i)));
    const PointCurvature& f = found[c];
    if (f.direction == Vec3{}) ++out.degenerate;
    k1[i] = saturated_float(f.k1);
    k2[i] = saturated_float(f.k2);
    direction[i] = stored_direction(f.direction);
    mean[i] = saturated_float((f.k1 + f.k2) / 2);
    gaussian[i] = saturated_float(f.k1 * f.k2);
    rms[i] = saturated_float(std::sqrt((f.k1 * f.k1 + f.k2 * f.k2) / 2));
    absolute[i] = saturated_float(f.k1 + f.k2);
    variation[i] = static_cast<float>(f.surface_variation);
    for (std::size_t e = 0; e < 3; ++e) eigenvalues[i][e] = static_cast<float>(f.normal_eigenvalues[e]);
  }
}

}  // namespace pointsweep
