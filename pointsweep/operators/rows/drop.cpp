// SPDX-License-Identifier: MIT
/// Attributes that the output does not hold and later stages do not see.
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

}  // namespace pointsweep
