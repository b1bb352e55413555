// SPDX-License-Identifier: MIT
#include "pointsweep/verify/set_formula.h"

#include <algorithm>
#include <optional>

#include "pointsweep/operators/set.h"
#include "pointsweep/operators/where.h"
#include "pointsweep/verify/formulas/assignment.h"

namespace pointsweep {
namespace {

using formulas::Estimate;
using formulas::Real;

struct ReadName {
  int read = -1;  ///< number in FormulaInput::reads; negative: the position
  std::size_t component = 0;
  bool is_whole = false;
};
std::vector<ReadName> sources_of(const formulas::PlainExpression& plain, const Expression& expression,
                                 const NamedValues& names, std::size_t first) {
  std::vector<ReadName> sources;
  for (const std::string& name : plain.names()) {
    const auto at = std::ranges::find(expression.names(), name, &Expression::Name::text) - expression.names().begin();
    const NamedValues::Source& source = names.sources()[static_cast<std::size_t>(at)];
    ReadName& read = sources.emplace_back();
    read.component = source.component;
    if (source.attribute < 0) continue;
    read.read = static_cast<int>(first) + source.attribute;
    const Type type = names.reads()[static_cast<std::size_t>(source.attribute)].type;
    read.is_whole = type == Type::i64 || type == Type::u64;
  }
  return sources;
}

std::vector<formulas::PossibleNumber> values_of(const std::vector<ReadName>& sources, const FormulaInput& in) {
  std::vector<formulas::PossibleNumber> values;
  for (const ReadName& name : sources) {
    const Estimate e = name.read < 0 ? Estimate{.value = in.place.at, .error = in.place.error}
                                     : in.reads[static_cast<std::size_t>(name.read)];
    const Real v = name.component == 0 ? e.value.x : name.component == 1 ? e.value.y : e.value.z;
    Real low = v, high = v;
    if (e.error > 0) low = v - e.error, high = v + e.error;
    if (e.may_be_undefined) low = std::min<Real>(low, 0), high = std::max<Real>(high, 0);
    if (e.either_sign) low = std::min(low, -high), high = std::max(high, -low);
    if (e.is_open() || name.component > 2) low = -formulas::kInfinity, high = formulas::kInfinity;
    values.push_back({low, high, name.is_whole});
  }
  return values;
}

class AssignmentFormula final : public StageFormula {
 public:
  explicit AssignmentFormula(const SetAttribute& op)
      : value_(op.assignment().value.text()),
        value_sources_(sources_of(value_, op.assignment().value, op.value_names(), op.first_of_value())),
        old_(op.old_value()),
        component_(op.component()),
        width_(op.target().fields.size()),
        moves_(op.target().name == position_attribute().name),
        storage_(op.range().is_whole             ? formulas::Storage::whole
                 : op.target().type == Type::f32 ? formulas::Storage::single
                                                 : formulas::Storage::real) {
    if (!op.assignment().condition) return;
    condition_.emplace(op.assignment().condition->text());
    condition_sources_ =
        sources_of(*condition_, *op.assignment().condition, op.condition_names(), op.first_of_condition());
  }
  std::vector<Estimate> evaluate(const FormulaInput& in) const override {
    std::optional<bool> holds = true;
    if (condition_) holds = condition_->holds(values_of(condition_sources_, in));
    if (!holds) return {formulas::open()};
    Estimate made = old_ ? in.reads[*old_] : Estimate{};
    if (moves_) made = {.value = in.place.at, .error = in.place.error};
    if (!*holds) return {made};
    const Estimate assigned = formulas::stored_number(value_.number(values_of(value_sources_, in)), storage_);
    if (made.either_sign || component_ > 2 || assigned.is_open()) return {formulas::open()};
    (component_ == 0 ? made.value.x : component_ == 1 ? made.value.y : made.value.z) = assigned.value.x;
    made.error = is_alone() ? assigned.error : made.error + assigned.error;
    if (is_alone()) made.may_be_undefined = false;
    return {made};
  }

 private:
  /// Whether the attribute is the assigned component alone.
  bool is_alone() const { return !moves_ && width_ == 1; }

  formulas::PlainExpression value_;
  std::vector<ReadName> value_sources_;
  std::optional<formulas::PlainExpression> condition_;
  std::vector<ReadName> condition_sources_;
  std::optional<std::size_t> old_;
  std::size_t component_, width_;
  bool moves_;
  formulas::Storage storage_;
};

/// 1 where the condition of a `where` holds, else 0; open where ranges do not tell.
class ConditionFormula final : public StageFormula {
 public:
  explicit ConditionFormula(const Where& op)
      : condition_(op.condition().text()), sources_(sources_of(condition_, op.condition(), op.names(), 0)) {}
  std::vector<Estimate> evaluate(const FormulaInput& in) const override {
    const std::optional<bool> holds = condition_.holds(values_of(sources_, in));
    return {holds ? Estimate{.value = {Real(*holds ? 1 : 0), 0, 0}} : formulas::open()};
  }

 private:
  formulas::PlainExpression condition_;
  std::vector<ReadName> sources_;
};

}  // namespace

std::unique_ptr<StageFormula> condition_formula_of(const Where& op) { return std::make_unique<ConditionFormula>(op); }

std::unique_ptr<StageFormula> set_formula_of(const SetAttribute& op) { return std::make_unique<AssignmentFormula>(op); }

}  // namespace pointsweep
