// SPDX-License-Identifier: MIT
#include <optional>

#include "pointsweep/verify/formulas/neighbor_statistics.h"
#include "pointsweep/verify/values/named_reads.h"
#include "pointsweep/verify/values/stage_formula.h"

namespace pointsweep {
namespace {

using formulas::Estimate;

class StatisticsFormula final : public StageFormula {
 public:
  explicit StatisticsFormula(const FormulaSetup& stage) {
    const std::vector<Attribute>& reads = stage.contract.reads_neighbors;
    if (stage.options.has("where")) {
      condition_.emplace(stage.options.word("where"));
      condition_reads_ = reads_of(*condition_, reads);
    }
    for (const Attribute& made : stage.contract.makes) {
      const std::size_t end = made.name.rfind('_');
      Result result{made.name.substr(end + 1), {}, made.type != Type::f32 && made.type != Type::f64};
      if (end != made.name.npos) result.of = read_of(made.name.substr(0, end), reads);
      results_.push_back(result);
    }
  }
  std::vector<Estimate> evaluate(const FormulaInput& in) const override {
    std::vector<FormulaInput> counted;
    for (std::size_t j = 0; j < in.neighbors.size(); ++j) {
      const FormulaInput neighbor = neighbor_of(in, j);
      std::optional<bool> holds = true;
      if (condition_) holds = condition_->holds(values_of(condition_reads_, neighbor));
      if (!holds) return std::vector<Estimate>(results_.size(), formulas::open());
      if (*holds) counted.push_back(neighbor);
    }
    std::vector<Estimate> made;
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
    for (const std::vector<Estimate>& attribute : in.of_neighbors) neighbor.reads.push_back(attribute[j]);
    return neighbor;
  }
  static Estimate result_of(const Result& result, const std::vector<FormulaInput>& counted) {
    std::vector<Estimate> values;
    for (const FormulaInput& neighbor : counted) {
      Estimate value;
      if (result.of) {
        value = estimate_of(*result.of, neighbor);
        if (result.of->component > 2) return formulas::open();
        value.value.x = component_of(value, *result.of);
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

std::vector<NamedFormula> statistics_formulas() { return {{"statistics", formula_made<StatisticsFormula>}}; }

}  // namespace pointsweep
