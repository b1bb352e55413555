// SPDX-License-Identifier: MIT
#include "pointsweep/operators/curvature.h"

#include <cstddef>
#include <span>

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
  const auto numbers = [&](std::size_t m) { return out.wanted(m) ? out.column<float>(m) : std::span<float>(); };
  const auto triples = [&](std::size_t m) { return out.wanted(m) ? out.column<Float3>(m) : std::span<Float3>(); };
  curvatures(in,
             {.k1 = numbers(0),
              .k2 = numbers(1),
              .direction = triples(2),
              .mean = numbers(3),
              .gaussian = numbers(4),
              .rms = numbers(5),
              .absolute = numbers(6),
              .surface_variation = numbers(7),
              .normal_eigenvalues = triples(8)},
             out.degenerate());
}

}  // namespace pointsweep
