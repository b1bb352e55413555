// SPDX-License-Identifier: MIT
/// The declarations of the instructions of a chain (chain.h), which compute nothing for a point: Drop, and the update
/// operators Reneighbor and Resort, which the paper requires after points have moved (Section 8). Reneighbor tells the
/// planner where a new sweep begins, Resort by which positions `--order sweep` orders the output.
#include <algorithm>
#include <string>
#include <vector>

#include "pointsweep/chain.h"
#include "pointsweep/fail.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"

namespace pointsweep {
namespace {

const OptionTable<Drop>& drop_options() {
  static const OptionTable<Drop> table = {
      option("attributes", &Drop::attributes,
             "attributes to leave out, of the input or computed by earlier stages; 'attributes=' may be left out",
             {.kind = OptionKind::attributes, .required = true, .positional = true, .sample = "intensity"})};
  return table;
}

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

OperatorDeclaration drop_declaration() {
  return {.name = "drop",
          .meaning = "leaves attributes out of the output; later stages cannot read them; x, y and z are always kept",
          .options = drop_options().declarations(),
          .make = [](const OptionValues& values, const Facts&) -> ChainStage { return drop_options().read(values); },
          .cost = "none: what is dropped is not computed either, unless a stage before reads it",
          .example = "knn(k=12) | normals | set(facing = nz * nz) | drop(normal)"};
}

ChainStage operators::drop(const std::vector<std::string>& attributes) {
  if (attributes.empty() || std::ranges::any_of(attributes, &std::string::empty))
    fail_usage("drop: names no attribute; write the names of those to leave out, as in drop(intensity, gps_time).");
  return Drop{attributes};
}

OperatorDeclaration reneighbor_declaration() {
  return {.name = "reneighbor",
          .meaning =
              "finds new neighbours at the moved positions, for all later stages; options as for knn (without k and "
              "radius: "
              "those in effect so far)",
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
