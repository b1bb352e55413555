// SPDX-License-Identifier: MIT
/// Keeping a number of points, chosen by a hash of their coordinates.
#pragma once

#include <memory>
#include <string>

#include "pointsweep/in_order_operator.h"
#include "pointsweep/operators.h"

namespace pointsweep {

struct OperatorDeclaration;

OperatorDeclaration sample_declaration();

/// Keeps the points with the least fractions (coordinate_fraction()), equal fractions in the order of their rows; with
/// SampleOptions::rest, keeps all other points instead. The place of a point is its fraction, so that points come in
/// this order. Points without a finite place are all kept.
class Sample final : public InOrderOperator {
 public:
  /// Throws UsageError for options out of their ranges.
  explicit Sample(const SampleOptions& options);
  std::string name() const override { return "sample"; }
  InOrderContract in_order_contract() const override;
  std::unique_ptr<InOrderWork> start(const InOrderSetup&) const override;
  Vec3 place_of(Vec3 position) const override;

 private:
  SampleOptions options_;
};

}  // namespace pointsweep
