// SPDX-License-Identifier: MIT
/// Dividing the points at random into parts, for training, validation and test.
#pragma once

#include <string>

#include "pointsweep/operator.h"
#include "pointsweep/operators.h"

namespace pointsweep {

struct OperatorDeclaration;

OperatorDeclaration parts_declaration();

/// Makes part, N u16: ⌊h n / 2^64⌋ with the hash h of the coordinates and n parts. Points of equal coordinates are in
/// the same part; points without a finite place are in part 0.
class Parts final : public LocalOperator {
 public:
  /// Throws UsageError for options out of their ranges.
  explicit Parts(const PartsOptions& options);
  std::string name() const override { return "parts"; }
  Contract contract() const override;
  void apply(const Neighborhoods& in, Columns& out) const override;

 private:
  PartsOptions options_;
};

}  // namespace pointsweep
