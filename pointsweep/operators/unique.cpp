// SPDX-License-Identifier: MIT
#include "pointsweep/operators/unique.h"

#include <memory>

#include "pointsweep/operators/declaration.h"

namespace pointsweep {

OperatorDeclaration unique_declaration() {
  return {.name = "unique",
          .meaning = "keeps of points with equal coordinates the first; later stages see neighbours among those kept",
          .make = [](const OptionValues&, const Facts&) { return std::make_shared<Unique>(); },
          .undefined = "Points without a finite place are all kept.",
          .cost = "a pass that puts the points in order, without a search",
          .example = "unique"};
}

}  // namespace pointsweep
