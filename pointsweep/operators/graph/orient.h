// SPDX-License-Identifier: MIT
/// Consistent signs of normals over a whole surface (H. Hoppe, T. DeRose, T. Duchamp, J. McDonald, W. Stuetzle,
/// "Surface reconstruction from unorganized points", SIGGRAPH 1992, Section 3.3).
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "pointsweep/chain.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/graph/orientation_votes.h"
#include "pointsweep/operators/kinds/connect_operator.h"
#include "pointsweep/operators/surface/facing_normals.h"

namespace pointsweep {

/// Returns normal_turned, N u8: 1 if the operator orient has negated the normal.
Attribute normal_turned_attribute();

/// Makes normal_turned: the signs along the minimum spanning forest of the graph of neighbours. An edge has the weight
/// 1 - |n_i . n_j| and asks for equal signs if n_i . n_j >= 0. OrientationVotes decides which components to turn.
class NormalSigns final : public ConnectOperator {
 public:
  explicit NormalSigns(const OrientOptions& options);
  std::string name() const override { return "normal_signs"; }
  Contract contract() const override {
    return {{normal_attribute()}, {normal_attribute()}, {normal_turned_attribute()}};
  }
  bool weighted() const override { return true; }
  const VoteRule* votes() const override { return &votes_; }
  void connect(const Neighborhoods& in, std::vector<NeighborEdge>& edges, std::byte* ballots) const override;
  void put_values(const ComponentLabel& label, std::byte* values) const override;

 private:
  OrientationVotes votes_;
};

/// Makes `normal`: the existing normal, negated if `normal_turned` is 1.
class TurnedNormals final : public LocalOperator {
 public:
  std::string name() const override { return "turned_normals"; }
  Contract contract() const override {
    return {.reads = {normal_attribute(), normal_turned_attribute()}, .makes = {normal_attribute()}, .default_k = 0};
  }
  void apply(const Neighborhoods& in, Columns& out) const override;
};

/// `orient`: NormalSigns, then TurnedNormals; or FacingNormals if the method is `trajectory`.
class OrientedNormals final : public CompositeOperator {
 public:
  /// Reads the trajectory, if the method needs one. Messages begin with `place`. Throws UsageError for options out of
  /// range or in conflict, and Error for a file that cannot be read.
  explicit OrientedNormals(OrientOptions options = {}, const std::string& place = "orient");
  std::string name() const override { return "orient"; }
  Contract contract() const override;
  std::vector<ChainStage> parts() const override;

 private:
  OrientOptions options_;  ///< options, with the checksum of the trajectory that was read
  std::shared_ptr<const FacingNormals> facing_;
};

}  // namespace pointsweep
