// SPDX-License-Identifier: MIT
/// The independent evaluation of an operator's formula, found by the operator's name and options.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/attribute.h"
#include "pointsweep/neighborhood.h"
#include "pointsweep/operator.h"
#include "pointsweep/option.h"
#include "pointsweep/verify/formulas/distances.h"
#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep {

/// The options of an operator or of a rule, by name.
class NamedOptions {
 public:
  /// `owner`: the name of the operator or rule, which begins messages, e.g. "density".
  NamedOptions(std::string owner, Options all) : owner_(std::move(owner)), all_(std::move(all)) {}

  bool has(std::string_view name) const { return find(name) != nullptr; }
  /// Each of the next four functions returns the value of an option. It throws UsageError if the option is absent or of
  /// another kind, which shows that the owner only shares its name with an operator of the library.
  double number(std::string_view name) const;
  std::uint64_t whole(std::string_view name) const;
  const std::string& word(std::string_view name) const;
  Vec3 point(std::string_view name) const;
  /// Returns the numbers of an option such as "1,2.5"; "inf" and "nan" are numbers, too.
  std::vector<double> numbers(std::string_view name) const;

  std::optional<double> number_if_given(std::string_view name) const {
    return has(name) ? std::optional(number(name)) : std::nullopt;
  }

 private:
  const OptionValue* find(std::string_view name) const;
  template <class T>
  const T& value(std::string_view name) const;

  std::string owner_;
  Options all_;
};

using Estimates = std::vector<formulas::Estimate>;

/// A point, its neighbours in the order of their list, and the values that a stage reads, in the order of its contract.
struct FormulaInput {
  formulas::Place place;
  std::span<const formulas::Place> neighbors;
  std::span<const std::uint64_t> rows;  ///< rows of the neighbours in the input
  Estimates reads;                      ///< for each attribute, the value of the point
  std::vector<Estimates> of_neighbors;  ///< for each attribute, the value of each neighbour
};

/// The formula of an operator: a pure function of a point and its neighbourhood, implemented in formulas/. It returns
/// estimates of the made attributes: one estimate for an attribute of up to three components, else one for each
/// component.
using StageFormula = std::function<Estimates(const FormulaInput& in)>;

/// Returns the number of estimates of an attribute's value.
inline std::size_t estimates_of(const Attribute& a) { return a.fields.size() <= 3 ? 1 : a.fields.size(); }

/// A value of the whole cloud that a stage needs, found independently of the run; NaN if it has not been found.
struct CloudThreshold {
  formulas::Real value = formulas::kNaN;
  formulas::Real error = 0;
};

/// The facts about a stage from which its formula is made.
struct FormulaSetup {
  NamedOptions options;
  Contract contract;
  CloudThreshold threshold = {};  ///< threshold of "outlier", the only stage that needs one
  /// Operator that makes each attribute of contract.reads; null for an attribute of the input.
  std::span<const Operator* const> makers = {};
};
FormulaSetup setup_of(const Operator& op);

/// The name of an operator, and the function that makes its formula.
struct NamedFormula {
  std::string_view name;
  StageFormula (*make)(const FormulaSetup& stage);
};

/// Makes a formula from a class `Formula`, a function object that is constructed from the setup.
template <class Formula>
StageFormula formula_made(const FormulaSetup& stage) {
  return Formula(stage);
}

/// Returns whether a formula has the name of the operator. The operator may still lack options whose values a run
/// computes.
bool has_stage_formula(const Operator& op);
/// Returns the formula of an operator; empty if has_stage_formula() is false.
StageFormula formula_of(const Operator& op, const CloudThreshold& threshold = {});

/// A function that returns how many of the found neighbours a rule keeps. `values`: values of the point that the rule
/// reads.
using RuleFormula = std::function<formulas::Kept(const formulas::Place&, std::span<const formulas::Place> neighbors,
                                                 std::span<const double> values)>;
/// Returns the formula of a rule; empty for rules that do not belong to this library.
RuleFormula formula_of(const NeighborhoodRule& rule);

/// Returns the formulas of the operators on surfaces, their shape and their normals, and of transform().
std::vector<NamedFormula> shape_formulas();

/// Returns the formulas of set(), of `where`, which makes selection_attribute(), and of statistics().
std::vector<NamedFormula> expression_formulas();

/// The value for which a name in an expression stands: a component of an attribute that a stage reads, or of the
/// position.
struct ReadValue {
  int attribute = -1;  ///< index of the attribute among those that the stage reads; negative for the position
  std::size_t component = 0;
};

/// Returns the value for which `name`, in any spelling, stands. `reads`: attributes that the stage reads.
ReadValue read_of(const std::string& name, const std::vector<Attribute>& reads);

/// Returns the estimate that has the value as its component ReadValue::component. Only for attributes of up to three
/// components: the components of a wider attribute have an estimate each.
formulas::Estimate estimate_of(const ReadValue& value, const FormulaInput& in);

}  // namespace pointsweep
