// SPDX-License-Identifier: MIT
/// DBSCAN: clusters of points that have many neighbours (M. Ester, H.-P. Kriegel, J. Sander, X. Xu, "A density-based
/// algorithm for discovering clusters in large spatial databases with noise", KDD 1996).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "pointsweep/chain.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/kinds/connect_operator.h"

namespace pointsweep {

/// Returns core, N u8: 1 for core points.
Attribute core_attribute();

/// Makes core: 1 where at least `min_points` points, the point itself included, lie within `eps` of it.
class CorePoints final : public LocalOperator {
 public:
  explicit CorePoints(const DbscanOptions& options);
  std::string name() const override { return "core"; }
  Contract contract() const override { return {{}, {}, {core_attribute()}}; }
  void apply(const Neighborhoods& in, Columns& out) const override;

 private:
  DbscanOptions options_;
};

/// Makes cluster and cluster_size: the components of core points within `eps` of each other. Any other point belongs to
/// the cluster of the nearest core point within `eps`; a point without such a core point is noise.
class ClustersOfCores final : public ConnectOperator {
 public:
  ClustersOfCores(const DbscanOptions& options, std::uint64_t points);
  std::string name() const override { return "clusters"; }
  Contract contract() const override;
  const VoteRule* votes() const override;
  void connect(const Neighborhoods& in, std::vector<NeighborEdge>& edges, std::byte* ballots) const override;
  void put_values(const ComponentLabel& label, std::byte* values) const override;

 private:
  double eps_;
  std::uint64_t points_;
};

/// `dbscan`: CorePoints, then ClustersOfCores. N_i must contain all points within eps. Pipelines without such
/// neighbourhoods are refused; C++ code must ensure it.
class DensityClusters final : public CompositeOperator {
 public:
  /// Throws UsageError for options out of their ranges. `points`: points of the cloud for has_short_numbers().
  explicit DensityClusters(const DbscanOptions& options, std::uint64_t points = 0);
  std::string name() const override { return "dbscan"; }
  Contract contract() const override;
  std::vector<ChainStage> parts() const override;

 private:
  DbscanOptions options_;
  std::uint64_t points_;
};

}  // namespace pointsweep
