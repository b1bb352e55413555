// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/registry.h"

#include "pointsweep/error.h"
#include "pointsweep/operators/curvature.h"
#include "pointsweep/operators/fair.h"
#include "pointsweep/operators/neighborhood_size.h"
#include "pointsweep/operators/normals.h"
#include "pointsweep/operators/splats.h"
#include "pointsweep/pipeline/nearest_names.h"
#include "pointsweep/pipeline/update_operators.h"

namespace pointsweep {
namespace {

std::shared_ptr<const Operator> make_normals(const OptionValues& options, const Facts&) {
  NormalsOptions normals;
  const std::string& orient = options.choice("orient");
  if (orient == "up") normals.orient = Orient::up;
  if (orient == "input") normals.orient = Orient::input;
  if (orient == "viewpoint") normals.orient = Orient::viewpoint;
  const bool towards = normals.orient == Orient::viewpoint;
  if (towards && !options.given("viewpoint"))
    fail_usage("{}: orient=viewpoint needs the point, as in viewpoint=[0,0,1.7].", options.where());
  if (!towards && options.given("viewpoint"))
    fail_usage("{}: viewpoint is used only with orient=viewpoint; add that, or leave the point out.", options.where());
  if (towards) normals.viewpoint = options.point("viewpoint");
  return std::make_shared<Normals>(normals);
}

std::shared_ptr<const Operator> make_curvature(const OptionValues&, const Facts&) {
  return std::make_shared<Curvature>();
}

std::shared_ptr<const Operator> make_splats(const OptionValues& options, const Facts& facts) {
  const std::string& axes = options.choice("axes");
  const bool curved = axes == "curvature" || (axes == "auto" && facts.made.contains(k1_direction_attribute().name));
  return std::make_shared<Splats>(SplatsOptions{.axes = curved ? SplatAxes::curvature : SplatAxes::positions});
}

std::shared_ptr<const Operator> make_fair(const OptionValues& options, const Facts& facts) {
  if (!(facts.diagonal > 0))
    fail_usage("{}: all points lie in one place, so there is nothing to smooth; leave the stage out.", options.where());
  const double percent = facts.diagonal / 100;
  return std::make_shared<Fair>(FairOptions{.f = options.number("f") * percent, .g = options.number("g") * percent});
}

std::shared_ptr<const Operator> make_reneighbor(const OptionValues& options, const Facts&) {
  if (!options.any_given()) return std::make_shared<Reneighbor>();
  return std::make_shared<Reneighbor>(make_neighborhood(options.with_presets_of(neighborhood_declaration().options)));
}

std::shared_ptr<const Operator> make_resort(const OptionValues&, const Facts&) { return std::make_shared<Resort>(); }

/// Those of knn; none is preset, for without any the neighbourhoods stay what they were.
std::vector<OptionDeclaration> options_of_reneighbor() {
  std::vector<OptionDeclaration> options = neighborhood_declaration().options;
  for (OptionDeclaration& option : options) option.preset.clear();
  return options;
}

std::shared_ptr<const Operator> make_neighborhood_size(const OptionValues&, const Facts&) {
  return std::make_shared<NeighborhoodSize>();
}

/// An option of fair: a width by which the paper's Gaussians are given.
OptionDeclaration width(std::string name, std::string meaning) {
  return {.name = std::move(name),
          .kind = OptionKind::number,
          .preset = "0.5",
          .meaning = std::move(meaning),
          .least = 1e-6,
          .most = 100};
}

std::vector<OperatorDeclaration> declare_operators() {
  return {
      {.name = "normals",
       .meaning = "unit normals, from the weighted covariance of the neighbours (Equation 1 of the paper)",
       .options = {{.name = "orient",
                    .kind = OptionKind::choice,
                    .preset = "none",
                    .meaning = "how to orient normals: none, up (towards +z), towards the viewpoint, or to the side of "
                               "the normals in the input",
                    .choices = {"none", "up", "viewpoint", "input"}},
                   {.name = "viewpoint",
                    .kind = OptionKind::point,
                    .preset = "",
                    .meaning = "position of the scanner, in the coordinates of the cloud; requires orient=viewpoint"}},
       .make = make_normals,
       .example = "knn(k=12) | normals(orient=viewpoint, viewpoint=[0,0,1.7])"},
      {.name = "curvature",
       .meaning =
           "principal curvatures and derived curvatures, from the covariance of the neighbours' normals (Equation 2)",
       .options = {},
       .make = make_curvature,
       .example = "knn(k=64) | normals | curvature"},
      {.name = "splats",
       .meaning = "elliptical splats that together cover the surface",
       .options = {{.name = "axes",
                    .kind = OptionKind::choice,
                    .preset = "auto",
                    .meaning = "what determines direction and ratio of the ellipses; auto is curvature if an earlier "
                               "stage makes it, else positions",
                    .choices = {"auto", "positions", "curvature"}}},
       .make = make_splats,
       .example = "knn(k=12) | normals | splats(axes=positions)"},
      {.name = "fair",
       .meaning = "edge-preserving smoothing: moves points towards the tangent planes of their neighbours (Equation 3)",
       .options = {width("f",
                         "standard deviation of the Gaussian of the distance to a neighbour, in % of the diagonal of "
                         "the input's bounding box"),
                   width("g",
                         "standard deviation of the Gaussian of the distance to its tangent plane, in % of the same "
                         "diagonal")},
       .make = make_fair,
       .needs_diagonal = true,
       .example = "knn(k=64) | normals | splats | fair(f=0.3, g=0.3) | normals"},
      {.name = "neighborhood_size",
       .meaning = "number of neighbours and distance of the farthest",
       .options = {},
       .make = make_neighborhood_size,
       .example = "knn(radius=0.1) | neighborhood_size"},
      {.name = "reneighbor",
       .meaning =
           "finds new neighbours at the moved positions, for all later stages; options as for knn (default: those "
           "in effect so far)",
       .options = options_of_reneighbor(),
       .make = make_reneighbor,
       .example = "knn(k=64) | normals | splats | fair | reneighbor(k=12) | normals"},
      {.name = "resort",
       .meaning = "makes --order sweep write the points in the order of the moved positions; changes no value",
       .options = {},
       .make = make_resort,
       .example = "knn(k=64) | normals | splats | fair | resort | normals"},
  };
}

}  // namespace

const std::vector<OperatorDeclaration>& all_operators() {
  static const std::vector<OperatorDeclaration> operators = declare_operators();
  return operators;
}

const OperatorDeclaration& find_operator(const StageText& stage) {
  std::vector<std::string> names = {neighborhood_declaration().name};
  for (const OperatorDeclaration& declaration : all_operators()) {
    if (declaration.name == stage.name) return declaration;
    names.push_back(declaration.name);
  }
  fail_usage("{}: no operator is called '{}'; the nearest are {}.", stage.place, stage.name,
             nearest_names(stage.name, names));
}

}  // namespace pointsweep
