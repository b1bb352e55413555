// SPDX-License-Identifier: MIT
#include "pointsweep/operators/rows/drop.h"

#include <algorithm>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/operators/declare/declaration.h"

namespace pointsweep {

OperatorDeclaration drop_declaration() {
  return {
      .name = "drop",
      .meaning = "leaves attributes out of the output; later stages cannot read them; x, y and z are always kept",
      .options = {{.name = "attributes",
                   .kind = OptionKind::attributes,
                   .meaning = "attributes to leave out, of the input or computed by earlier stages; 'attributes=' "
                              "may be left out",
                   .required = true,
                   .positional = true,
                   .sample = std::string("intensity")}},
      .make = [](const OptionValues& options, const Facts&) { return drop_of(words_of(options.word("attributes"))); },
      .cost = "none: what is dropped is not computed either, unless a stage before reads it",
      .example = "knn(k=12) | normals | set(facing = nz * nz) | drop(normal)"};
}

Drop drop_of(std::vector<std::string> attributes) {
  if (attributes.empty() || std::ranges::any_of(attributes, &std::string::empty))
    fail_usage("drop: names no attribute; write the names of those to leave out, as in drop(intensity, gps_time).");
  return {std::move(attributes)};
}

}  // namespace pointsweep
