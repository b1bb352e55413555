// SPDX-License-Identifier: MIT
/// Attributes that the output does not hold and later stages do not see.
#pragma once

#include <string>
#include <vector>

#include "pointsweep/operator.h"

namespace pointsweep {

struct OperatorDeclaration;

OperatorDeclaration drop_declaration();

class Drop final : public Operator {
 public:
  /// Names of attributes made before, or of fields of the input in any spelling. Throws UsageError without any.
  explicit Drop(std::vector<std::string> attributes);
  std::string name() const override { return "drop"; }
  Contract contract() const override { return {.alone = true, .drops = attributes_}; }
  void apply(const Neighborhoods&, Columns&) const override {}

 protected:
  Options own_options() const override;

 private:
  std::vector<std::string> attributes_;
};

/// Keeps all rows: what a chain does that makes nothing and only drops.
class AllRows final : public Operator {
 public:
  std::string name() const override { return "drop"; }
  Contract contract() const override { return {{}, {}, {selection_attribute()}, true, Selects::by_value}; }
  void apply(const Neighborhoods& in, Columns& out) const override;
};

}  // namespace pointsweep
