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
  /// `place`: for messages. Throws UsageError for an empty range.
  explicit Color(ColorOptions options, std::string place = "color");
  std::string name() const override { return "color"; }
  Contract contract() const override;
  void apply(const Neighborhoods& in, Columns& out) const override;
  std::shared_ptr<const LocalOperator> bound(const Schema& input, std::span<const Attribute> made) const override;
  std::shared_ptr<const LocalOperator> with_values(std::span<const std::vector<double>> values) const override;

 private:
  /// Returns, after bound(), the component of an attribute or of the position that is shown.
  NamedValues::Source source() const { return names_.sources().front(); }
  template <class T>
  void fill(std::span<const ExpressionValues> values, Columns& out) const;

  ColorOptions options_;
  std::string place_;
  NamedValues names_;
  bool of_input_ = false;  ///< the input has the values
  Type type_ = Type::u8;
};

}  // namespace pointsweep
