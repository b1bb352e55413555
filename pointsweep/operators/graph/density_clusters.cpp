// SPDX-License-Identifier: MIT
/// DBSCAN: clusters of points that have many neighbours (M. Ester, H.-P. Kriegel, J. Sander, X. Xu, "A density-based
/// algorithm for discovering clusters in large spatial databases with noise", KDD 1996).
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "pointsweep/chain.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"
#include "pointsweep/operators/kinds/connect_operator.h"

namespace pointsweep {
namespace {

/// Gives a number to each component that has a core point; the points of other components are noise. The result for a
/// component is one byte: 1 if the component has a core point, else 0.
class AnyCore final : public VoteRule {
 public:
  std::size_t ballot_bytes() const override { return 1; }
  std::size_t bytes() const override { return 1; }
  void start(std::byte* votes, const PointKey&, const std::byte* ballot) const override { *votes = *ballot; }
  void merge(std::byte* into, const std::byte* from, bool) const override { *into |= *from; }
  std::size_t result_bytes() const override { return 1; }
  void conclude(const std::byte* votes, std::byte* result) const override { *result = *votes; }
  bool counts(const std::byte* result) const override { return *result != std::byte{0}; }
};

const OptionTable<DbscanOptions>& dbscan_options() {
  static const OptionTable<DbscanOptions> table = {
      option("eps", &DbscanOptions::eps,
             "the distance within which points are neighbours, inclusive; a knn before it has to hold all of them",
             {.least = kAboveZero, .unit = "length", .required = true, .sample = 0.5, .is_radius = true}),
      option("min_points", &DbscanOptions::min_points,
             "number of points within eps that make a core point, itself included", {.least = 1})};
  return table;
}

/// Returns the nearest core point within eps, at equal distances the first by x, y, z, row; nullopt if there is none.
std::optional<NeighborRef> nearest_core(const Neighborhoods& in, std::size_t i, double eps2) {
  using Key = std::tuple<double, double, double, double, std::uint64_t>;
  std::optional<NeighborRef> nearest;
  Key least;
  for (std::size_t j = 0; j < in.count(i); ++j) {
    const double d2 = in.distance2(i, j);
    if (!(d2 <= eps2) || in.neighbor_value<std::uint8_t>(0, i, j) == 0) continue;
    const Vec3 p = in.neighbor_position(i, j);
    const Key key{d2, p.x, p.y, p.z, in.neighbor_row(i, j)};
    if (!nearest || key < least) nearest = in.neighbors(i)[j], least = key;
  }
  return nearest;
}

/// Returns core, one uint8 per point: 1 for core points.
Attribute core_attribute() { return scalar("core", Type::u8, "1", "1: at least min_points points within eps"); }

/// Makes core: 1 for a point if at least `min_points` points, the point itself included, lie within `eps`, inclusive;
/// else 0.
class CorePoints final : public LocalOperator {
 public:
  explicit CorePoints(const DbscanOptions& options) : options_(options) { dbscan_options().declare(*this, options); }
  std::string name() const override { return "core"; }
  Contract contract() const override { return {{}, {}, {core_attribute()}}; }
  void apply(const Neighborhoods& in, Columns& out) const override {
    const std::span<std::uint8_t> core = out.column<std::uint8_t>(0);
    const double eps2 = options_.eps * options_.eps;
    for (std::size_t i = 0; i < in.size(); ++i) {
      std::uint64_t near = is_finite(in.position(i)) ? 1 : 0;
      for (std::size_t j = 0; j < in.count(i) && near < options_.min_points; ++j) near += in.distance2(i, j) <= eps2;
      core[i] = near >= options_.min_points;
    }
  }

 private:
  DbscanOptions options_;
};

/// Makes cluster and cluster_size: the components of core points within `eps` of each other. Any other point belongs to
/// the cluster of the nearest core point within `eps`; a point without such a core point is noise.
class ClustersOfCores final : public ConnectOperator {
 public:
  ClustersOfCores(const DbscanOptions& options, std::uint64_t points) : eps_(options.eps), points_(points) {
    dbscan_options().declare(*this, options);
  }
  std::string name() const override { return "clusters"; }
  Contract contract() const override {
    return {{core_attribute()},
            {core_attribute()},
            {component_number("cluster", "number of the cluster; -1: noise", points_),
             component_size("cluster_size", "points of the cluster; 0: noise", points_)}};
  }
  const VoteRule* votes() const override { return &any_core_; }
  /// The core point with the lower row emits the edge between two core points. Other points emit at most one edge each,
  /// so that they join no clusters.
  void connect(const Neighborhoods& in, std::vector<NeighborEdge>& edges, std::byte* ballots) const override {
    const double eps2 = eps_ * eps_;
    for (std::uint32_t i = 0; i < in.size(); ++i) {
      const bool is_core = in.value<std::uint8_t>(0, i) != 0;
      ballots[i] = std::byte(is_core);
      if (!is_core) {
        if (const auto core = nearest_core(in, i, eps2)) edges.push_back({i, *core});
        continue;
      }
      for (std::size_t j = 0; j < in.count(i); ++j)
        if (in.row(i) < in.neighbor_row(i, j) && in.distance2(i, j) <= eps2 &&
            in.neighbor_value<std::uint8_t>(0, i, j) != 0)
          edges.push_back({i, in.neighbors(i)[j]});
    }
  }
  void put_values(const ComponentLabel& label, std::byte* values) const override {
    ComponentLabel cluster = label;
    if (label.number == ComponentLabel::kNone) cluster.points = 0;
    put_component(cluster, has_short_numbers(points_), values);
  }

 private:
  double eps_;
  std::uint64_t points_;
  AnyCore any_core_;
};

/// `dbscan`: CorePoints, then ClustersOfCores. The neighbours N_i of a point must include all points within eps.
/// Pipelines without such neighbourhoods are refused; C++ callers must provide them.
class DensityClusters final : public CompositeOperator {
 public:
  /// Throws UsageError for options out of their ranges. `points`: points of the cloud for has_short_numbers().
  explicit DensityClusters(const DbscanOptions& options, std::uint64_t points = 0)
      : options_(options), points_(points) {
    dbscan_options().declare(*this, options);
  }
  std::string name() const override { return "dbscan"; }
  Contract contract() const override {
    Contract contract = ClustersOfCores(options_, points_).contract();
    contract.makes.insert(contract.makes.begin(), core_attribute());
    return {.makes = contract.makes, .all_within = options_.eps};
  }
  std::vector<ChainStage> parts() const override {
    return {std::make_shared<CorePoints>(options_), std::make_shared<ClustersOfCores>(options_, points_)};
  }

 private:
  DbscanOptions options_;
  std::uint64_t points_;
};

ChainStage make_dbscan(const OptionValues& values, const Facts& facts) {
  const DbscanOptions options = dbscan_options().read(values);
  require_complete_lists(facts, Neighborhood::kUnlimited, options.eps, values.where());
  return std::make_shared<DensityClusters>(options, facts.points);
}

}  // namespace

OperatorDeclaration dbscan_declaration() {
  return {.name = "dbscan",
          .meaning = "density-based clusters (DBSCAN): points around core points, which have many neighbours",
          .options = dbscan_options().declarations(),
          .make = make_dbscan,
          .formula =
              "core_i = 1 where |{j : |p_j - p_i| <= eps}| >= min_points, i itself counted, as in scikit-learn.\n"
              "Core points within eps of each other are in one cluster. Another point is in that of the nearest "
              "core point within eps, equal distances by x, y, z, row; without one it is noise, cluster = -1.\n"
              "Clusters are numbered from 0 by their first point, that of the least x, then y, then z, then row.\n"
              "In scikit-learn and in the publication a border point belongs to the cluster that comes to it "
              "first, so that its cluster depends on the order of the points.",
          .source =
              "Ester, Kriegel, Sander, Xu, A density-based algorithm for discovering clusters in large spatial "
              "databases with noise (KDD 1996)",
          .undefined = "core 0, cluster -1 and cluster_size 0 for points without a finite place.",
          .cost = "a sweep of two steps that ends a pass; about 60 bytes a point in the temporary folder",
          .neighbor_ns = 15,
          .attributes = {{.name = "core", .meaning = "1: at least min_points points within eps; else 0"},
                         {.name = "cluster", .meaning = "number of the cluster; noise: -1", .type = kNumberTypes},
                         {.name = "cluster_size", .meaning = "points of the cluster; noise: 0", .type = kSizeTypes}},
          .example = "knn(radius=0.5) | dbscan(eps=0.5, min_points=10) | where(cluster >= 0)"};
}

ChainStage operators::dbscan(const DbscanOptions& options) { return std::make_shared<DensityClusters>(options); }

}  // namespace pointsweep
