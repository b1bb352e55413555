// SPDX-License-Identifier: MIT
/// Declarations of operators, for people and programs. docs/operators.md and the table of docs/attributes.md are made
/// of these texts by script/docs.
#pragma once

#include <string>
#include <vector>

#include "pointsweep/operators/declare/declaration.h"
#include "pointsweep/operators/declare/neighborhood_declaration.h"

namespace pointsweep {

/// An operator, or the stage knn, with what its contract says where all options have their presets.
struct ListedOperator {
  OperatorDeclaration declaration;  ///< of knn: without a maker
  Contract contract = {};
};

/// Returns the contract of an operator whose options have their presets, without what is never written.
Contract contract_of(const OperatorDeclaration& declaration);

/// Returns a sentence about the number of neighbours that the operator uses by default; empty if it uses no neighbours
/// or needs a radius.
std::string default_k_text(const ListedOperator& listed);

/// knn and all operators of pipelines; of these the ones named, in the order named, if any are. Throws UsageError for
/// an unknown one.
std::vector<ListedOperator> listed_operators(const std::vector<std::string>& names);

/// Returns the help of an operator or of knn for the terminal, with a command that runs it; empty if no operator has
/// that name.
std::string help_of_operator(const std::string& name);
/// "pointsweep run IN... OUT --pipeline 'voxel(0.5)'"; empty where no operator has that name.
std::string command_of_operator(const std::string& name);

/// Returns the listing as text for the terminal.
std::string to_text(const std::vector<ListedOperator>& operators);
/// An array of objects; docs/pipelines as JSON use the same names and values.
std::string to_json(const std::vector<ListedOperator>& operators);
/// docs/operators.md.
std::string to_markdown(const std::vector<ListedOperator>& operators);
/// The table of docs/attributes.md, including what the verb neighbors makes.
std::string attributes_markdown();

}  // namespace pointsweep
