// SPDX-License-Identifier: MIT
#include "pointsweep/operators/surface/curvature.h"

#include <cstddef>
#include <memory>
#include <span>

#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"

namespace pointsweep {

Attribute k1_attribute() { return scalar("k1", Type::f32, "1/length", "larger principal curvature, without sign"); }
Attribute k2_attribute() { return scalar("k2", Type::f32, "1/length", "smaller principal curvature, without sign"); }
Attribute k1_direction_attribute() {
  return {"k1_direction", Type::f32, Kind::vector, {"k1_x", "k1_y", "k1_z"}, "1", "unit tangent along which k1 is"};
}

OperatorDeclaration curvature_declaration() {
  return {
      .name = "curvature",
      .meaning =
          "principal curvatures and derived curvatures, from the covariance of the neighbours' normals (Equation 2)",
      .make = [](const OptionValues&, const Facts&) { return std::make_shared<Curvature>(); },
      .formula =
          "Over the m neighbours that have a normal, u_j = n_j / |n_j|:\n"
          "S = 1/m Σ_j u_j u_j^T, eigenvalues μ0 <= μ1 <= μ2, eigenvectors e0, e1, e2\n"
          "D = 1/m Σ_j (p_j - p̄)(p_j - p̄)^T, p̄ their mean\n"
          "t1: e1 in the tangent plane of n_i, or e0 × n_i where e0 is nearer to that plane, as a unit vector; t2 = "
          "n_i × t1\n"
          "Curvatures along t1 and t2: √(μ1 / t1^T D t1) and √(μ0 / t2^T D t2); k1 is the larger.\n"
          "C_i = 1/|N_i| Σ_j n_j n_j^T θ(|p_j - p_i|), θ and M_i as in normals.",
      .source =
          "Pajarola, Stream-Processing Points (IEEE Visualization 2005), Section 4.3.2, Equation 2; the step from "
          "variances to curvatures is ours (docs/paper.md)",
      .undefined =
          "All values are 0 where the point has no normal, fewer than three neighbours have one, or the neighbours "
          "that have one lie on a line as seen along the normal.",
      .degenerate = "have no normal, or too few neighbours with normals; their curvatures are 0",
      .cost =
          "at k = 8 about 510 cycles per point with AVX2, after the search; attributes that are not kept cost nothing",
      .neighbor_ns = 12,
      .attributes = {{.name = "k1", .meaning = "larger principal curvature, without sign; undefined: 0"},
                     {.name = "k2",
                      .meaning = "smaller principal curvature, without sign, k1 >= k2 >= 0; undefined: 0"},
                     {.name = "k1_direction",
                      .meaning =
                          "unit tangent in the direction of k1; its sign has no meaning: the largest component is "
                          "positive. The direction of k2 is its cross product with the normal; undefined: 0"},
                     {.name = "mean_curvature", .meaning = "(k1 + k2) / 2; undefined: 0"},
                     {.name = "gaussian_curvature", .meaning = "k1 k2, without sign; undefined: 0"},
                     {.name = "rms_curvature", .meaning = "√((k1² + k2²) / 2); undefined: 0"},
                     {.name = "absolute_curvature", .meaning = "k1 + k2; undefined: 0"},
                     {.name = "surface_variation", .meaning = "λ0 / (λ0 + λ1 + λ2) of M_i, in [0, 1/3]; undefined: 0"},
                     {.name = "normal_eigenvalues",
                      .meaning = "eigenvalues of C_i of Equation 2 as the paper has it, ascending; undefined: 0"}},
      .example = "knn(k=64) | normals | curvature"};
}

ChainStage operators::curvature() { return std::make_shared<Curvature>(); }

Contract Curvature::contract() const {
  return {
      .reads = {normal_attribute()},
      .reads_neighbors = {normal_attribute()},
      .makes = {k1_attribute(),
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
                 "eigenvalues of C_i, ascending"}},
      .default_k = 32};
}

void Curvature::apply(const Neighborhoods& in, Columns& out) const {
  using Triple = std::array<float, 3>;
  const auto numbers = [&](std::size_t m) { return out.wanted(m) ? out.column<float>(m) : std::span<float>(); };
  const auto triples = [&](std::size_t m) { return out.wanted(m) ? out.column<Triple>(m) : std::span<Triple>(); };
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
