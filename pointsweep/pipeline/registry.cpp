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
       .meaning = "unit normals of the surface, by the weighted covariance of the neighbours",
       .options = {{.name = "orient",
                    .kind = OptionKind::choice,
                    .preset = "none",
                    .meaning = "side to point to: any, upwards, to the viewpoint, or as normals already there",
                    .choices = {"none", "up", "viewpoint", "input"}},
                   {.name = "viewpoint",
                    .kind = OptionKind::point,
                    .preset = "",
                    .meaning = "where the scanner stood, in the coordinates of the cloud; with orient=viewpoint"}},
       .make = make_normals},
      {.name = "curvature",
       .meaning = "principal curvatures and what follows from them, by the covariance of the neighbours' normals",
       .options = {},
       .make = make_curvature},
      {.name = "splats",
       .meaning = "ellipses that cover the surface together",
       .options = {{.name = "axes",
                    .kind = OptionKind::choice,
                    .preset = "auto",
                    .meaning = "what turns and flattens them; auto: curvature where an earlier stage makes it",
                    .choices = {"auto", "positions", "curvature"}}},
       .make = make_splats},
      {.name = "fair",
       .meaning = "moves points towards the tangent planes of their neighbours, sparing edges",
       .options = {width(
                       "f",
                       "standard deviation of the Gaussian of the distance to a neighbour, % of the input's diagonal"),
                   width("g",
                         "standard deviation of the Gaussian of the distance to its tangent plane, % of the input's "
                         "diagonal")},
       .make = make_fair,
       .needs_diagonal = true},
      {.name = "neighborhood_size",
       .meaning = "how many neighbours a point has and how far they reach",
       .options = {},
       .make = make_neighborhood_size},
      {.name = "reneighbor",
       .meaning = "neighbourhoods from here on are those of the positions as they are now; options as of knn, without "
                  "any what it said before",
       .options = options_of_reneighbor(),
       .make = make_reneighbor},
      {.name = "resort",
       .meaning = "the order from here on is that of the positions as they are now; it changes what --order sweep "
                  "writes and no value",
       .options = {},
       .make = make_resort},
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
