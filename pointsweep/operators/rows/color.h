// SPDX-License-Identifier: MIT
/// Colours from the values of an attribute.
#pragma once

#include <memory>
#include <string>

#include "pointsweep/operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/expressions/named_values.h"

namespace pointsweep {

struct OperatorDeclaration;

OperatorDeclaration color_declaration();

/// Makes "color": red, green and blue.
class Color final : public LocalOperator {
 public:
  /// Messages begin with `place`. Throws UsageError for a range that is not two ascending numbers, or with classes.
  explicit Color(ColorOptions options, std::string place = "color");
  std::string name() const override { return "color"; }
  Contract contract() const override;
  void apply(const Neighborhoods& in, Columns& out) const override;
  std::shared_ptr<const LocalOperator> bound(const Schema& input, std::span<const Attribute> made) const override;
  std::shared_ptr<const LocalOperator> with_values(std::span<const std::vector<double>> values) const override;

 private:
  /// Returns the source of the values that are coloured. Must be called after bound().
  NamedValues::Source source() const { return names_.sources().front(); }
  template <class T>
  void fill(std::span<const ExpressionValues> values, Columns& out) const;

  ColorOptions options_;
  std::string place_;
  NamedValues names_;
  bool of_input_ = false;  ///< true if the values are those of the input, and no earlier stage has made them
  Type type_ = Type::u8;
};

}  // namespace pointsweep
