// SPDX-License-Identifier: MIT
/// The declarations of Reneighbor and Resort (chain.h), the update operators that the paper asks for after points have
/// moved (Section 8). They compute nothing for a point: they tell the planner where a new sweep begins and how the
/// output is ordered.
#include "pointsweep/chain.h"
#include "pointsweep/operators/declare/declarations.h"

namespace pointsweep {
namespace {

constexpr const char* kUpdateSource = "Pajarola, Stream-Processing Points (IEEE Visualization 2005), Section 8";

Reneighbor make_reneighbor(const OptionValues& options, const Facts&) {
  if (!options.any_given()) return Reneighbor();
  return Reneighbor(make_neighborhood(options.with_presets_of(neighborhood_declaration().options)));
}

/// Returns the options of knn without presets, since without options the neighbourhoods keep their size and radius.
std::vector<OptionDeclaration> options_of_reneighbor() {
  std::vector<OptionDeclaration> options = neighborhood_declaration().options;
  for (OptionDeclaration& option : options) option.preset = {};
  return options;
}

}  // namespace

OperatorDeclaration reneighbor_declaration() {
  return {.name = "reneighbor",
          .meaning =
              "finds new neighbours at the moved positions, for all later stages; options as for knn (default: those "
              "in effect so far)",
          .options = options_of_reneighbor(),
          .make = make_reneighbor,
          .formula = "N_i from here on is that of a file that holds the positions of now.",
          .source = kUpdateSource,
          .undefined = "A point that was moved to a position that is not finite has no neighbours from here on.",
          .cost = "one more sweep, and one temporary record for each point",
          .example = "knn(k=64) | normals | splats | fair | reneighbor(k=12) | normals"};
}

OperatorDeclaration resort_declaration() {
  return {.name = "resort",
          .meaning = "makes --order sweep write the points in the order of the moved positions; changes no value",
          .make = [](const OptionValues&, const Facts&) { return Resort(); },
          .source = kUpdateSource,
          .cost = "one more ordering of the output, with --order sweep",
          .example = "knn(k=64) | normals | splats | fair | resort | normals"};
}

}  // namespace pointsweep
