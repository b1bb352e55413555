// SPDX-License-Identifier: MIT
/// Keeping the points for which a condition holds.
#include <cassert>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"
#include "pointsweep/operators/expressions/expression.h"
#include "pointsweep/operators/expressions/named_values.h"

namespace pointsweep {
namespace {

struct WhereOptions {
  std::string condition = {};
};

const OptionTable<WhereOptions>& where_options() {
  static const OptionTable<WhereOptions> table = {
      option("condition", &WhereOptions::condition,
             "attributes of the input or made before, row (the number of the point in the inputs, from 0), numbers, "
             "functions such as abs, + - * /, == != < <= > >=, "
             "in (2, 9), between 2 and 5, && || ! or the words and, or, not, and parentheses; "
             "'condition=' may be left out",
             {.kind = OptionKind::condition, .required = true, .positional = true, .sample = "z > 0"})};
  return table;
}

/// Keeps the rows for which `condition` holds, e.g. classification == 2 && z < 100. Points without a finite place are
/// tested like all others: x, y or z is then NaN or infinite, and made attributes have the documented value for
/// undefined results.
class Where final : public SelectOperator {
 public:
  /// Messages begin with `place`, e.g. "pipeline, column 12: where". Throws UsageError for a text that is no condition.
  /// The declared option is the canonical text, so that conditions that differ only in blanks are equal.
  explicit Where(std::string_view condition, std::string place = "where")
      : condition_(condition, place), place_(std::move(place)) {
    where_options().declare(*this, {condition_.canonical()});
  }
  std::string name() const override { return "where"; }
  std::vector<Attribute> reads() const override { return names_.reads(); }
  void keep(const Neighborhoods& points, std::span<std::uint8_t> kept) const override {
    assert(names_.sources().size() == condition_.names().size());
    const NamedValues::Batch batch(names_, points);
    condition_.evaluate(batch.values(), kept);
  }
  /// Throws UsageError for an unknown name, with the known names.
  std::shared_ptr<const SelectOperator> bound(const Schema& input, std::span<const Attribute> made) const override {
    auto bound = std::make_shared<Where>(*this);
    bound->names_ = NamedValues(condition_, place_, input, made);
    return bound;
  }

 private:
  Expression condition_;
  std::string place_;
  NamedValues names_;  ///< empty before bound()
};

ChainStage make_where(const OptionValues& values, const Facts&) {
  return std::make_shared<Where>(where_options().read(values).condition, values.where());
}

}  // namespace

OperatorDeclaration where_declaration() {
  return {
      .name = "where",
      .meaning = "keeps the points for which a condition on attributes holds; later stages see neighbours among these",
      .options = where_options().declarations(),
      .make = make_where,
      .undefined = "Points without a finite place are asked like all others: their coordinates are NaN or infinite.",
      .cost = "a pass over the rows, without a search; one more sweep if a later stage needs neighbours again",
      .example = "knn(k=12) | where(z > 0 && z < 100) | normals"};
}

ChainStage operators::where(std::string_view condition) { return std::make_shared<Where>(condition); }

}  // namespace pointsweep
