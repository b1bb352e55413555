// SPDX-License-Identifier: MIT
/// The local outlier factor: how much sparser the surroundings of a point are than those of its neighbours (M. M.
/// Breunig, H.-P. Kriegel, R. T. Ng, J. Sander, "LOF: identifying density-based local outliers", 2000).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pointsweep/chain.h"
#include "pointsweep/operator.h"

namespace pointsweep {

/// The attributes of the operators below, N f64 each. They are NaN for points without neighbours, and if a neighbour
/// has no finite place.
Attribute k_distance_attribute();
Attribute reachability_density_attribute();
Attribute lof_attribute();

/// Makes k_distance: the distance to the farthest neighbour.
class KDistance final : public LocalOperator {
 public:
  std::string name() const override { return "k_distance"; }
  Contract contract() const override { return {{}, {}, {k_distance_attribute()}}; }
  void apply(const Neighborhoods& in, Columns& out) const override;
};

/// Makes reachability_density: |N_i| / Σ_j max(k_distance_j, |p_j - p_i|), in the order of the neighbours; infinite if
/// all terms of the sum are 0.
class ReachabilityDensity final : public LocalOperator {
 public:
  std::string name() const override { return "reachability_density"; }
  Contract contract() const override { return {{}, {k_distance_attribute()}, {reachability_density_attribute()}}; }
  void apply(const Neighborhoods& in, Columns& out) const override;
};

/// Makes lof: 1/|N_i| Σ_j r_j / r_i with reachability densities r, in the order of the neighbours. The quotient of two
/// infinite densities is 1.
class DensityRatio final : public LocalOperator {
 public:
  std::string name() const override { return "density_ratio"; }
  Contract contract() const override {
    return {{reachability_density_attribute()}, {reachability_density_attribute()}, {lof_attribute()}};
  }
  void apply(const Neighborhoods& in, Columns& out) const override;
};

/// `lof`: KDistance, ReachabilityDensity and DensityRatio, in order.
class LocalOutlierFactor final : public CompositeOperator {
 public:
  std::string name() const override { return "lof"; }
  Contract contract() const override {
    return {.makes = {k_distance_attribute(), reachability_density_attribute(), lof_attribute()}, .default_k = 32};
  }
  std::vector<ChainStage> parts() const override;
};

}  // namespace pointsweep
