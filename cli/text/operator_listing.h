// SPDX-License-Identifier: MIT
/// Declarations of operators, for people and programs. script/docs makes docs/operators.md and the table of
/// docs/attributes.md from these texts.
#pragma once

#include <string>
#include <vector>

#include "pointsweep/program/declaration.h"

namespace pointsweep {

/// An operator, or the stage knn, and its contract with the default values of all options.
struct ListedOperator {
  OperatorDeclaration declaration;  ///< `make` is empty for knn
  Contract contract = {};
};

/// Returns the kind of an attribute as a word, e.g. "normal".
const char* kind_text(const Attribute& attribute);

/// Returns a sentence about the number of neighbours that the operator uses by default; empty if it uses no neighbours
/// or needs a radius.
std::string default_k_text(const ListedOperator& listed);

/// Returns knn and all operators of pipelines; if any are named, only these, in the given order. Throws UsageError for
/// an unknown name.
std::vector<ListedOperator> listed_operators(const std::vector<std::string>& names);

/// Returns the help of an operator or of knn for the terminal, with a command that runs it; empty if no operator has
/// that name.
std::string help_of_operator(const std::string& name);
/// Returns a command that runs the operator, e.g. "pointsweep run IN... OUT --pipeline 'voxel(0.5)'"; empty if no
/// operator has that name.
std::string command_of_operator(const std::string& name);

/// Returns the listing as text for the terminal.
std::string to_text(const std::vector<ListedOperator>& operators);
/// Returns the listing as a JSON array of objects, with the names and values that pipelines in JSON use.
std::string to_json(const std::vector<ListedOperator>& operators);
/// Returns the text of docs/operators.md.
std::string to_markdown(const std::vector<ListedOperator>& operators);
/// Returns the table of docs/attributes.md, including the attributes of the verb neighbors.
std::string attributes_markdown();

}  // namespace pointsweep
