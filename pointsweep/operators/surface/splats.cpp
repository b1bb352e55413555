// SPDX-License-Identifier: MIT
#include "pointsweep/operators/surface/splats.h"

#include <memory>

#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"
#include "pointsweep/operators/expressions/named_values.h"
#include "pointsweep/operators/surface/curvature.h"

namespace pointsweep {
namespace {

const OptionTable<SplatsOptions>& splats_options() {
  static const OptionTable<SplatsOptions> table = {
      option("axes", &SplatsOptions::axes,
             "derive direction and ratio of the ellipses from curvature or from positions; auto takes curvature if an "
             "earlier stage computes it and no stage drops it",
             {.choices = {"auto", "positions", "curvature"}})};
  return table;
}

}  // namespace

OperatorDeclaration splats_declaration() {
  return {
      .name = "splats",
      .meaning = "elliptical splats that together cover the surface",
      .options = splats_options().declarations(),
      .make = splats_options().maker<Splats>(),
      .formula =
          "An ellipse around p_i in the tangent plane of n_i, grown until it holds eight neighbours; with m < 8 "
          "neighbours, √(8/m) times as long as one that holds all. Neighbours on the normal through p_i do not count.\n"
          "axes=positions: major axis along the largest eigenvector of M_i (Equation 1), ratio √(λ1/λ2).\n"
          "axes=curvature: major axis along the direction of k2, ratio √(k2/k1).\n"
          "Ratios are at least 1/8.",
      .source =
          "Pajarola, Stream-Processing Points (IEEE Visualization 2005), Section 4.3.3; the size is ours "
          "(docs/paper.md)",
      .undefined = "All values are 0 where the point has no normal or no neighbour off the point.",
      .degenerate = "have no normal, or no neighbour elsewhere; their splats are 0",
      .cost = "at k = 8 about 150 cycles per point with AVX2, after the search",
      .attributes = {{.name = "splat_axis",
                      .meaning = "unit tangent along the major axis; its sign has no meaning; undefined: 0"},
                     {.name = "splat_length", .meaning = "major semi-axis; undefined: 0"},
                     {.name = "splat_ratio",
                      .meaning = "minor over major semi-axis, in [1/8, 1] wherever there is a splat; undefined: 0"}},
      .example = "knn(k=12) | normals | splats(axes=positions)"};
}

ChainStage operators::splats(const SplatsOptions& options) { return std::make_shared<Splats>(options); }

Splats::Splats(const SplatsOptions& options) : options_(options) { splats_options().declare(*this, options); }

std::shared_ptr<const LocalOperator> Splats::bound(const Schema&, std::span<const Attribute> made) const {
  if (options_.axes != SplatAxes::automatic) return nullptr;
  auto bound = std::make_shared<Splats>(*this);
  const bool curved = makes(made, k1_direction_attribute().name);
  bound->options_.axes = curved ? SplatAxes::curvature : SplatAxes::positions;
  return bound;
}

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
  Contract contract{.reads = {normal_attribute()},
                    .makes = {splat_axis_attribute(), splat_length_attribute(), splat_ratio_attribute()},
                    .default_k = 16};
  if (options_.axes == SplatAxes::curvature)
    contract.reads.insert(contract.reads.end(), {k1_direction_attribute(), k1_attribute(), k2_attribute()});
  return contract;
}

void Splats::apply(const Neighborhoods& in, Columns& out) const {
  fit_splats(
      in, options_.axes == SplatAxes::curvature,
      {.axis = out.column<std::array<float, 3>>(0), .length = out.column<float>(1), .ratio = out.column<float>(2)},
      out.degenerate());
}

}  // namespace pointsweep
