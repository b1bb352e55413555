// SPDX-License-Identifier: MIT
/// Statistics of attributes over the neighbours of a point: means, medians, ranges, majorities, counts (docs/adr/0019).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/expressions/expression.h"
#include "pointsweep/operators/expressions/named_values.h"

namespace pointsweep {

struct OperatorDeclaration;

OperatorDeclaration statistics_declaration();

enum class Statistic : std::uint8_t { mean, median, min, max, range, deviation, majority, count };

/// `statistics`: makes one attribute for each name of StatisticsOptions::of. The neighbours that count satisfy the
/// condition and have a finite value. Values are combined in float64 in the order of the search; min, max and majority
/// keep the type of the attribute. Points without a neighbour that counts are degenerate: they get the fill of the
/// attribute, NaN or 0, and a count of 0.
class NeighborhoodStatistics final : public LocalOperator {
 public:
  /// Throws UsageError that begins with `place` for a name that ends in no statistic, or is given twice.
  explicit NeighborhoodStatistics(const StatisticsOptions& options, std::string place = "statistics");
  std::string name() const override { return "statistics"; }
  Contract contract() const override;
  void apply(const Neighborhoods& in, Columns& out) const override;
  /// Throws UsageError for an unknown attribute; the message names the known attributes.
  std::shared_ptr<const LocalOperator> bound(const Schema& input, std::span<const Attribute> made) const override;

 private:
  /// An attribute of the neighbours. If `attribute` is empty, the neighbours themselves are counted.
  struct Source {
    std::string attribute;
    NamedValues names = {};      ///< empty before bound()
    Type type = Type::f64;       ///< type of min, max and majority
    std::size_t first_read = 0;  ///< index of its value in contract().reads_neighbors
  };
  /// A column that the operator makes.
  struct Result {
    std::string name;
    Statistic what;
    std::size_t source;
  };
  struct Lists;

  void add_result(const std::string& name);
  Attribute attribute_of(const Result& result) const;
  /// Removes the neighbours for which the condition does not hold from `lists`.
  void keep_those_that_satisfy(const Neighborhoods& in, Lists& lists) const;
  void fill(std::size_t source, const Neighborhoods& in, const Lists& lists, Columns& out) const;
  void fill_counts(std::size_t source, std::span<const std::size_t> begin, std::size_t first_point, Columns& out) const;
  template <class Value>
  void fill_from(std::size_t source, std::span<const Value> values, std::span<const std::size_t> begin,
                 std::size_t first_point, Columns& out) const;

  std::string place_;
  std::vector<Source> sources_;
  std::vector<Result> results_;
  std::optional<Expression> condition_;
  NamedValues condition_names_;  ///< empty before bound(); its attributes come first in contract().reads_neighbors
};

}  // namespace pointsweep
