// SPDX-License-Identifier: MIT
#include "pointsweep/operators/surface/normals.h"

#include <array>
#include <cstddef>
#include <memory>
#include <span>

#include "pointsweep/fail.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"

namespace pointsweep {
namespace {

using Normal = std::array<float, 3>;

double dot(Normal n, Vec3 v) { return pointsweep::dot({n[0], n[1], n[2]}, v); }

/// Returns a number that is negative if the normal must be flipped.
double along_wanted(const NormalsOptions& options, const Neighborhoods& in, std::size_t i, Normal n) {
  switch (options.orient) {
    case Orient::none:
      break;
    case Orient::up:
      return n[2];
    case Orient::viewpoint:
      return dot(n, *options.viewpoint - in.position(i));
    case Orient::input:
      return dot(n, in.vector(0, i));
  }
  return 0;
}

const OptionTable<NormalsOptions>& normals_options() {
  static const OptionTable<NormalsOptions> table = {
      option("orient", &NormalsOptions::orient,
             "how to orient normals: none, up (towards +z), towards the viewpoint, or to the side of the normals in "
             "the input",
             {.choices = {"none", "up", "viewpoint", "input"}}),
      option("viewpoint", &NormalsOptions::viewpoint,
             "position of the scanner for orient=viewpoint, in the coordinates of the cloud",
             {.unit = "length", .sample = Vec3{0, 0, 1.7}})};
  return table;
}

}  // namespace

OperatorDeclaration normals_declaration() {
  return {.name = "normals",
          .meaning = "unit normals, from the weighted covariance of the neighbours (Equation 1 of the paper)",
          .options = normals_options().declarations(),
          .make = normals_options().maker<Normals>(),
          .formula =
              "n_i: eigenvector of the smallest eigenvalue of\n"
              "M_i = 1/|N_i| Σ_j (p_j - p_i)(p_j - p_i)^T θ(|p_j - p_i|)\n"
              "θ(r) = exp(-r² / 2σ²), σ² = π max_j |p_j - p_i|² / |N_i|; |N_i| does not count p_i.\n"
              "orient=none: the first of the largest components is positive.\n"
              "orient=up, viewpoint, input: the dot product with +z, the direction to the viewpoint or the "
              "normal of the input is positive; where it is 0, as for none.",
          .source = "Pajarola, Stream-Processing Points (IEEE Visualization 2005), Section 3.2, Equation 1",
          .undefined =
              "(0, 0, 0) where the neighbours define no plane: fewer than two, all on the point, or all on a line.",
          .degenerate = "have too few neighbours, or only neighbours on a line; their normals are 0",
          .cost = "at k = 8 about 190 cycles per point with AVX2, after the search",
          .neighbor_ns = 4,
          .attributes = {{.name = "normal", .meaning = "unit surface normal; undefined: 0"}},
          .example = "knn(k=12) | normals(orient=viewpoint, viewpoint=[0,0,1.7])"};
}

ChainStage operators::normals(const NormalsOptions& options) { return std::make_shared<Normals>(options); }

Normals::Normals(const NormalsOptions& options, const std::string& place) : options_(options) {
  normals_options().declare(*this, options);
  const bool towards = options.orient == Orient::viewpoint;
  if (towards && !options.viewpoint)
    fail_usage("{}: orient=viewpoint needs the point, as in viewpoint=[0,0,1.7].", place);
  if (!towards && options.viewpoint)
    fail_usage("{}: viewpoint is used only with orient=viewpoint; add that, or leave the point out.", place);
}

Contract Normals::contract() const {
  Contract contract{.makes = {normal_attribute()}, .default_k = 16};
  if (options_.orient == Orient::input) contract.reads = {normal_attribute()};
  return contract;
}

void Normals::apply(const Neighborhoods& in, Columns& out) const {
  const std::span<Normal> normals = out.column<Normal>(0);
  unoriented_normals(in, normals, out.degenerate());
  if (options_.orient == Orient::none) return;
  for (std::size_t i = 0; i < in.size(); ++i)
    if (along_wanted(options_, in, i, normals[i]) < 0) normals[i] = flipped(normals[i]);
}

}  // namespace pointsweep
