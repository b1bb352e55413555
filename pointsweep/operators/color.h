// SPDX-License-Identifier: MIT
/// Colours from the values of an attribute.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "pointsweep/operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/named_values.h"

namespace pointsweep {

struct OperatorDeclaration;

OperatorDeclaration color_declaration();

/// Makes "color": red, green and blue.
class Color final : public LocalOperator {
 public:
  /// `place`: for messages. Throws UsageError for a range that is none.
  explicit Color(ColorOptions options, std::string place = "color");
  std::string name() const override { return "color"; }
  Contract contract() const override;
  void apply(const Neighborhoods& in, Columns& out) const override;
  std::shared_ptr<const LocalOperator> bound(const Schema& input, std::span<const Attribute> made) const override;
  std::shared_ptr<const LocalOperator> with_values(std::span<const std::vector<double>> values) const override;

  const ColorOptions& options() const { return options_; }
  /// After bound(): of an attribute that is read, or of the position.
  NamedValues::Source source() const { return names_.sources().front(); }
  /// 8, or 16 where 65535 is the brightest.
  unsigned bits() const { return type_ == Type::u16 ? 16 : 8; }
  /// The ends of the colour map; absent until they are known, and where the map has none.
  std::optional<double> lo() const { return lo_; }
  std::optional<double> hi() const { return hi_; }

 protected:
  Options own_options() const override;

 private:
  template <class T>
  void fill(std::span<const ExpressionValues> values, Columns& out) const;

  ColorOptions options_;
  std::string place_;
  NamedValues names_;
  bool of_input_ = false;  ///< the input has the values
  Type type_ = Type::u8;
  std::optional<double> lo_, hi_;
};

}  // namespace pointsweep
