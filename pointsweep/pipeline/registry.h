// SPDX-License-Identifier: MIT
/// The operators by name. A new one is its own pair of files and an entry in registry.cpp: from the declaration come
/// the pipeline language, JSON, help and messages.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "pointsweep/operators/operator.h"
#include "pointsweep/pipeline/options.h"
#include "pointsweep/search/best_list.h"

namespace pointsweep {

/// What an operator may have to know of the cloud, and of the stages before it, when it is made.
struct Facts {
  std::uint64_t points = 0;
  double diagonal = 1;  ///< of the box around all finite points; found only for operators that say they need it
  std::set<std::string> made = {};  ///< names of the attributes that earlier stages make
};

struct OperatorDeclaration {
  std::string name;
  std::string meaning;  ///< one line
  std::vector<OptionDeclaration> options;
  std::function<std::shared_ptr<const Operator>(const OptionValues&, const Facts&)> make;
  bool needs_diagonal = false;
  std::string example = {};  ///< a whole pipeline as one writes it
};

/// In the order of their presentation.
const std::vector<OperatorDeclaration>& all_operators();

/// The one stage of a pipeline that is no operator: it defines the neighbourhood of all others.
struct NeighborhoodDeclaration {
  std::string name;
  std::string meaning;
  std::vector<OptionDeclaration> options;
  std::string example;  ///< a whole pipeline as one writes it
};
const NeighborhoodDeclaration& neighborhood_declaration();
Neighborhood make_neighborhood(const OptionValues& options);

/// The operator `stage` names. Throws UsageError naming the nearest known ones.
const OperatorDeclaration& find_operator(const StageText& stage);

}  // namespace pointsweep
