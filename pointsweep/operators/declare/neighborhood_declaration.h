// SPDX-License-Identifier: MIT
/// The stage `knn` of a pipeline, which is no operator: it defines the neighbourhoods of all stages.
#pragma once

#include <string>
#include <vector>

#include "pointsweep/neighborhood.h"
#include "pointsweep/operators/declare/declaration.h"

namespace pointsweep {

struct NeighborhoodDeclaration {
  std::string name;
  std::string meaning;
  std::vector<OptionDeclaration> options;
  std::string formula, source, cost;
  std::string example;  ///< a complete pipeline
};

const NeighborhoodDeclaration& neighborhood_declaration();

/// Throws UsageError, beginning with OptionValues::where(), for values that do not go together.
Neighborhood make_neighborhood(const OptionValues& options);

}  // namespace pointsweep
