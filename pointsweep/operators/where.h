// SPDX-License-Identifier: MIT
/// Keeping the points for which a condition holds.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/operator.h"
#include "pointsweep/operators/expression.h"

namespace pointsweep {

struct OperatorDeclaration;

OperatorDeclaration where_declaration();

/// Keeps the rows for which `condition` holds, e.g. classification == 2 && z < 100. A name is a component of an
/// attribute made before ("nz", "outlier"), else x, y or z, the position of now, else a field of the input in any
/// spelling that files use; of arrays none. Points without a finite place are asked like all others: x, y and z are
/// then NaN or infinite, made attributes have the documented value of none.
class Where final : public Operator {
 public:
  /// `place`: for messages, e.g. "pipeline, column 12: where". Throws UsageError for a text that is no condition.
  explicit Where(std::string_view condition, std::string place = "where");
  std::string name() const override { return "where"; }
  Contract contract() const override { return {reads_, {}, {selection_attribute()}, true, Selects::by_value}; }
  void apply(const Neighborhoods& in, Columns& out) const override;
  /// Throws UsageError for a name that fits nothing, with those there are.
  std::shared_ptr<const Operator> bound(const Schema& input, std::span<const Attribute> made) const override;
  const Expression& condition() const { return condition_; }

  /// Where the values of a name are: component `component` of reads_[attribute]; or of the position if that is
  /// negative.
  struct Source {
    int attribute = -1;
    std::size_t component = 0;
  };

 protected:
  Options own_options() const override { return {{"condition", condition_.canonical()}}; }

 private:
  Source source_of(const Expression::Name& name, const Schema& input, std::span<const Attribute> made);
  Source read(Attribute attribute, std::size_t component);
  [[noreturn]] void refuse(const Expression::Name& name, const std::string& what) const;

  Expression condition_;
  std::string place_;
  std::vector<Attribute> reads_;
  std::vector<Source> sources_;  ///< by number of the name; empty before bound()
};

}  // namespace pointsweep
