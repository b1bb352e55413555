// SPDX-License-Identifier: MIT
/// The independent evaluation of an operator's formula, found by the operator's name and options.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "pointsweep/attribute.h"
#include "pointsweep/neighborhood.h"
#include "pointsweep/operator.h"
#include "pointsweep/verify/formulas/distances.h"
#include "pointsweep/verify/formulas/estimate.h"
#include "pointsweep/verify/values/named_options.h"

namespace pointsweep {

/// A point, its neighbours in the order of their list, and the values that a stage reads, in the order of its contract.
struct FormulaInput {
  formulas::Place place;
  std::span<const formulas::Place> neighbors;
  std::span<const std::uint64_t> rows;                        ///< rows of the neighbours in the input
  std::vector<formulas::Estimate> reads;                      ///< values of the point, by attribute
  std::vector<std::vector<formulas::Estimate>> of_neighbors;  ///< values of neighbours, by attribute, then neighbour
};

/// A pure function of a point and its neighbourhood, like the operator, implemented in formulas/.
class StageFormula {
 public:
  virtual ~StageFormula() = default;
  /// Returns estimates of the made attributes: one estimate for an attribute of up to three components, else one for
  /// each component.
  virtual std::vector<formulas::Estimate> evaluate(const FormulaInput& in) const = 0;
};

/// Estimates that an attribute takes.
inline std::size_t estimates_of(const Attribute& a) { return a.fields.size() <= 3 ? 1 : a.fields.size(); }

/// A value of the whole cloud that a stage needs, found independently; NaN: not found.
struct CloudThreshold {
  formulas::Real value = std::numeric_limits<formulas::Real>::quiet_NaN();
  formulas::Real error = 0;
};

/// The facts that a formula knows of its stage.
struct FormulaSetup {
  NamedOptions options;
  Contract contract;
  CloudThreshold threshold = {};                 ///< threshold of "outlier", the only stage that needs one
  std::span<const Operator* const> makers = {};  ///< makers of the attributes of contract.reads; null: the input has it
};
FormulaSetup setup_of(const Operator& op);

/// The formula of the operators of one name.
struct NamedFormula {
  std::string_view name;
  std::unique_ptr<StageFormula> (*make)(const FormulaSetup& stage);
};

template <class Formula>
std::unique_ptr<StageFormula> formula_made(const FormulaSetup& stage) {
  if constexpr (std::is_default_constructible_v<Formula>)
    return std::make_unique<Formula>();
  else
    return std::make_unique<Formula>(stage);
}

/// Returns the formula of an operator; null if no formula has its name.
std::unique_ptr<StageFormula> formula_of(const Operator& op, const CloudThreshold& threshold = {});

/// Returns how many of the neighbours found a rule keeps; `values` are the rule's reads() of the point.
using RuleFormula = std::function<formulas::Kept(const formulas::Place&, std::span<const formulas::Place> neighbors,
                                                 std::span<const double> values)>;
/// Empty for rules that are not of this library.
RuleFormula formula_of(const NeighborhoodRule& rule);

/// Formulas of the operators on surfaces, their shape and their normals.
std::vector<NamedFormula> shape_formulas();

/// The formulas of set() and of `where`, which makes selection_attribute().
std::vector<NamedFormula> assignment_formulas();

/// The formula of transform().
std::vector<NamedFormula> transform_formulas();

/// The formula of statistics().
std::vector<NamedFormula> statistics_formulas();

/// The value that a name in an expression means: a component of an attribute that a stage reads, or of the position.
struct ReadValue {
  int attribute = -1;  ///< negative: the position
  std::size_t component = 0;
};

/// Finds the meaning of `name`, in any spelling. `reads`: attributes that the stage reads.
ReadValue read_of(const std::string& name, const std::vector<Attribute>& reads);

formulas::Estimate estimate_of(const ReadValue& value, const FormulaInput& in);
/// Returns the component of an estimate. An estimate has three at most; a wider attribute has an estimate for each.
formulas::Real component_of(const formulas::Estimate& estimate, const ReadValue& value);

}  // namespace pointsweep
