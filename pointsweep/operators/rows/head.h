// SPDX-License-Identifier: MIT
/// Keeping the first points of the inputs.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/operator.h"
#include "pointsweep/operators.h"

namespace pointsweep {

struct OperatorDeclaration;

OperatorDeclaration head_declaration();

/// Keeps the points of the first rows of all inputs in order. Rows are numbered like `row` in conditions, independently
/// of rows that earlier stages have dropped.
class Head final : public SelectOperator {
 public:
  /// Throws UsageError for a number of 0.
  explicit Head(const HeadOptions& options);
  std::string name() const override { return "head"; }
  std::vector<Attribute> reads() const override;
  void keep(const Neighborhoods& points, std::span<std::uint8_t> kept) const override;

 private:
  HeadOptions options_;
};

}  // namespace pointsweep
