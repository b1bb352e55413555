// SPDX-License-Identifier: MIT
/// Formulas of the operators whose options are expressions: set, where and statistics.
#include <algorithm>
#include <optional>
#include <vector>

#include "pointsweep/operators/rows/set.h"
#include "pointsweep/verify/formulas/neighbor_statistics.h"
#include "pointsweep/verify/formulas/plain_expression.h"
#include "pointsweep/verify/values/stage_formula.h"
#include "pointsweep/verify/values/stored_values.h"

namespace pointsweep {
namespace {

using formulas::Estimate;
using formulas::Real;

/// The value for which a name in an expression stands.
struct NamedRead {
  ReadValue value;
  bool is_whole = false;  ///< true if the value is a 64-bit integer
};

/// Returns the read value of each name of the expression, in the order of names(). `reads` are the attributes that the
/// stage reads.
std::vector<NamedRead> reads_of(const formulas::PlainExpression& expression, const std::vector<Attribute>& reads) {
  std::vector<NamedRead> named;
  for (const std::string& name : expression.names()) {
    const ReadValue value = read_of(name, reads);
    const Type type = value.attribute < 0 ? Type::f64 : reads[static_cast<std::size_t>(value.attribute)].type;
    named.push_back({value, type == Type::i64 || type == Type::u64});
  }
  return named;
}

/// Returns the range of the value of each name at a point.
std::vector<formulas::PossibleNumber> values_of(const std::vector<NamedRead>& names, const FormulaInput& in) {
  std::vector<formulas::PossibleNumber> values;
  for (const NamedRead& name : names) {
    const Estimate e = estimate_of(name.value, in);
    const Real v = e.value[name.value.component];
    Real low = v, high = v;
    if (e.error > 0) low = v - e.error, high = v + e.error;
    if (e.may_be_undefined) low = std::min<Real>(low, 0), high = std::max<Real>(high, 0);
    if (e.either_sign) low = std::min(low, -high), high = std::max(high, -low);
    if (e.is_open() || name.value.component > 2) low = -formulas::kInfinity, high = formulas::kInfinity;
    values.push_back({low, high, name.is_whole});
  }
  return values;
}

/// Returns the component of `target` that an assignment to `name` sets.
std::size_t component_named(const std::string& name, const Attribute& target) {
  if (target.name == position_attribute().name) return read_of(name, {}).component;
  return target.fields.size() == 1 ? 0 : read_of(name, {target}).component;
}

/// Returns the index of the last attribute with this name; nothing if no attribute has it.
std::optional<std::size_t> last_of_name(const std::string& name, const std::vector<Attribute>& reads) {
  for (std::size_t r = reads.size(); r-- > 0;)
    if (reads[r].name == name) return r;
  return std::nullopt;
}

class AssignmentFormula {
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
  Estimates operator()(const FormulaInput& in) const {
    std::optional<bool> holds = true;
    if (condition_) holds = condition_->holds(values_of(condition_reads_, in));
    if (!holds) return {formulas::open()};
    Estimate made = old_ ? in.reads[*old_] : Estimate{};
    if (moves_) made = {.value = in.place.at, .error = in.place.error};
    if (!*holds) return {made};
    const Estimate assigned = formulas::stored_number(value_.number(values_of(value_reads_, in)), storage_);
    if (made.either_sign || component_ > 2 || assigned.is_open()) return {formulas::open()};
    made.value[component_] = assigned.value.x;
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

/// Returns the formula of the condition of a `where`: 1 if it holds, else 0; open if the ranges do not decide.
StageFormula condition_formula(const FormulaSetup& stage) {
  const formulas::PlainExpression condition(stage.options.word("condition"));
  return [condition, reads = reads_of(condition, stage.contract.reads)](const FormulaInput& in) {
    const std::optional<bool> holds = condition.holds(values_of(reads, in));
    return Estimates{holds ? formulas::exactly(*holds ? 1 : 0) : formulas::open()};
  };
}

class StatisticsFormula {
 public:
  explicit StatisticsFormula(const FormulaSetup& stage) {
    const std::vector<Attribute>& reads = stage.contract.reads_neighbors;
    if (stage.options.has("where")) {
      condition_.emplace(stage.options.word("where"));
      condition_reads_ = reads_of(*condition_, reads);
    }
    for (const Attribute& made : stage.contract.makes) {
      const std::size_t end = made.name.rfind('_');
      Result result{made.name.substr(end + 1), {}, storage_of(made.type) == formulas::Storage::whole};
      if (end != made.name.npos) result.of = read_of(made.name.substr(0, end), reads);
      results_.push_back(result);
    }
  }
  Estimates operator()(const FormulaInput& in) const {
    std::vector<FormulaInput> counted;
    for (std::size_t j = 0; j < in.neighbors.size(); ++j) {
      const FormulaInput neighbor = neighbor_of(in, j);
      std::optional<bool> holds = true;
      if (condition_) holds = condition_->holds(values_of(condition_reads_, neighbor));
      if (!holds) return Estimates(results_.size(), formulas::open());
      if (*holds) counted.push_back(neighbor);
    }
    Estimates made;
    for (const Result& result : results_) made.push_back(result_of(result, counted));
    return made;
  }

 private:
  struct Result {
    std::string statistic;
    std::optional<ReadValue> of;  ///< value of the neighbours; absent if the neighbours themselves are counted
    bool is_whole;
  };

  /// Returns neighbour j with the values that the stage reads of it.
  static FormulaInput neighbor_of(const FormulaInput& in, std::size_t j) {
    FormulaInput neighbor{.place = in.neighbors[j], .neighbors = {}, .rows = {}, .reads = {}, .of_neighbors = {}};
    for (const Estimates& attribute : in.of_neighbors) neighbor.reads.push_back(attribute[j]);
    return neighbor;
  }
  static Estimate result_of(const Result& result, const std::vector<FormulaInput>& counted) {
    Estimates values;
    for (const FormulaInput& neighbor : counted) {
      Estimate value;
      if (result.of) {
        value = estimate_of(*result.of, neighbor);
        if (result.of->component > 2) return formulas::open();
        value.value.x = value.value[result.of->component];
      }
      values.push_back(value);
    }
    const Estimate made = formulas::statistic_of(result.statistic, values);
    return result.is_whole && std::isnan(made.value.x) ? formulas::undefined() : made;
  }

  std::optional<formulas::PlainExpression> condition_;
  std::vector<NamedRead> condition_reads_;
  std::vector<Result> results_;
};

}  // namespace

std::vector<NamedFormula> expression_formulas() {
  return {{"set", formula_made<AssignmentFormula>},
          {"where", condition_formula},
          {"statistics", formula_made<StatisticsFormula>}};
}

}  // namespace pointsweep
