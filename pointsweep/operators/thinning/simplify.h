// SPDX-License-Identifier: MIT
/// Keeping few points where the surface is flat.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pointsweep/chain.h"
#include "pointsweep/operator.h"
#include "pointsweep/operators.h"

namespace pointsweep {

struct OperatorDeclaration;

OperatorDeclaration simplify_declaration();

/// Returns simplify_radius, N f64, in length units: the distance up to which a kept point may represent the point.
Attribute simplify_radius_attribute();

/// Makes simplify_radius = √(2 error / k1), limited to `least` and `most`: within it, a surface of curvature k1
/// deviates from its tangent plane by at most the error, to second order. A point without curvature gets `most`.
class SimplifyRadius final : public LocalOperator {
 public:
  explicit SimplifyRadius(const SimplifyOptions& options) : options_(options) {}
  std::string name() const override { return "simplify_radius"; }
  Contract contract() const override;
  void apply(const Neighborhoods& in, Columns& out) const override;

 private:
  SimplifyOptions options_;
};

/// `simplify`: SimplifyRadius, then Poisson with simplify_radius as the radius of each point.
class Simplify final : public CompositeOperator {
 public:
  /// Messages begin with `place`. Throws UsageError for options out of their ranges, and if least is more than most.
  explicit Simplify(const SimplifyOptions& options, const std::string& place = "simplify");
  std::string name() const override { return "simplify"; }
  Contract contract() const override;
  std::vector<ChainStage> parts() const override;

 private:
  SimplifyOptions options_;
};

}  // namespace pointsweep
