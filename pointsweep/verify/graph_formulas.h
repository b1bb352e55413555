// SPDX-License-Identifier: MIT
/// Formulas of the operators that connect points: whole graphs in memory.
#pragma once

#include <memory>

#include "pointsweep/verify/cloud_formula.h"

namespace pointsweep {

class ClustersOfCores;
class ConnectedComponents;
class CorePoints;
class NormalSigns;
class Segments;

std::unique_ptr<CloudFormula> graph_formula_of(const ConnectedComponents& op);
/// `cores`: what makes the core points; null: not known.
std::unique_ptr<CloudFormula> graph_formula_of(const ClustersOfCores& op, const CorePoints* cores);
std::unique_ptr<CloudFormula> graph_formula_of(const Segments& op);
std::unique_ptr<CloudFormula> graph_formula_of(const NormalSigns& op);

}  // namespace pointsweep
