// SPDX-License-Identifier: MIT
#include <algorithm>
#include <optional>

#include "pointsweep/operators/rows/set.h"
#include "pointsweep/verify/formulas/assignment.h"
#include "pointsweep/verify/values/named_reads.h"
#include "pointsweep/verify/values/stage_formula.h"

namespace pointsweep {
namespace {

using formulas::Estimate;
using formulas::Real;

/// Returns the component of `target` that an assignment to `name` sets.
std::size_t component_named(const std::string& name, const Attribute& target) {
  if (target.name == position_attribute().name) return read_of(name, {}).component;
  return target.fields.size() == 1 ? 0 : read_of(name, {target}).component;
}

formulas::Storage storage_of(Type type) {
  if (type == Type::f32) return formulas::Storage::single;
  return type == Type::f64 ? formulas::Storage::real : formulas::Storage::whole;
}

/// Returns the index of the last attribute with this name; nothing if no attribute has it.
std::optional<std::size_t> last_of_name(const std::string& name, const std::vector<Attribute>& reads) {
  for (std::size_t r = reads.size(); r-- > 0;)
    if (reads[r].name == name) return r;
  return std::nullopt;
}

class AssignmentFormula final : public StageFormula {
 public:
  explicit AssignmentFormula(const FormulaSetup& stage)
      : AssignmentFormula(assignments_of(stage.options.word("assign"), "set").front(), stage.contract) {}
  AssignmentFormula(const Assignment& assignment, const Contract& contract)
      : value_(assignment.value.text()),
        value_reads_(reads_of(value_, contract.reads)),
        old_(last_of_name(contract.makes.front().name, contract.reads)),
        component_(component_named(assignment.name, contract.makes.front())),
        width_(contract.makes.front().fields.size()),
        moves_(contract.makes.front().name == position_attribute().name),
        storage_(storage_of(contract.makes.front().type)) {
    if (!assignment.condition) return;
    condition_.emplace(assignment.condition->text());
    condition_reads_ = reads_of(*condition_, contract.reads);
  }
  std::vector<Estimate> evaluate(const FormulaInput& in) const override {
    std::optional<bool> holds = true;
    if (condition_) holds = condition_->holds(values_of(condition_reads_, in));
    if (!holds) return {formulas::open()};
    Estimate made = old_ ? in.reads[*old_] : Estimate{};
    if (moves_) made = {.value = in.place.at, .error = in.place.error};
    if (!*holds) return {made};
    const Estimate assigned = formulas::stored_number(value_.number(values_of(value_reads_, in)), storage_);
    if (made.either_sign || component_ > 2 || assigned.is_open()) return {formulas::open()};
    (component_ == 0 ? made.value.x : component_ == 1 ? made.value.y : made.value.z) = assigned.value.x;
    made.error = is_alone() ? assigned.error : made.error + assigned.error;
    if (is_alone()) made.may_be_undefined = false;
    return {made};
  }

 private:
  /// Returns whether the attribute has only the assigned component.
  bool is_alone() const { return !moves_ && width_ == 1; }

  formulas::PlainExpression value_;
  std::vector<NamedRead> value_reads_;
  std::optional<formulas::PlainExpression> condition_;
  std::vector<NamedRead> condition_reads_;
  std::optional<std::size_t> old_;
  std::size_t component_, width_;
  bool moves_;
  formulas::Storage storage_;
};

/// The formula of the condition of a `where`: 1 if it holds, else 0; open if the ranges do not decide.
class ConditionFormula final : public StageFormula {
 public:
  explicit ConditionFormula(const FormulaSetup& stage)
      : condition_(stage.options.word("condition")), reads_(reads_of(condition_, stage.contract.reads)) {}
  std::vector<Estimate> evaluate(const FormulaInput& in) const override {
    const std::optional<bool> holds = condition_.holds(values_of(reads_, in));
    return {holds ? Estimate{.value = {Real(*holds ? 1 : 0), 0, 0}} : formulas::open()};
  }

 private:
  formulas::PlainExpression condition_;
  std::vector<NamedRead> reads_;
};

}  // namespace

std::vector<NamedFormula> assignment_formulas() {
  return {{"set", formula_made<AssignmentFormula>}, {"where", formula_made<ConditionFormula>}};
}

}  // namespace pointsweep
