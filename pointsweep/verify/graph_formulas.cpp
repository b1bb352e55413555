// SPDX-License-Identifier: MIT
#include "pointsweep/verify/graph_formulas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <tuple>

#include "pointsweep/operators/connected_components.h"
#include "pointsweep/operators/density_clusters.h"
#include "pointsweep/operators/orient.h"
#include "pointsweep/operators/segments.h"
#include "pointsweep/verify/formulas/joined_sets.h"
#include "pointsweep/verify/formulas/turning.h"
#include "pointsweep/verify/sorted_cloud.h"

namespace pointsweep {
namespace {

using formulas::Estimate;
using formulas::JoinedSets;
using Estimates = std::vector<Estimate>;

void require_plain_neighbors(const CloudInput& in) {
  if (in.has_rule) throw NotTold("neighbourhoods differ from point to point");
}

Estimate exact(double value) { return {.value = {value, 0, 0}}; }

/// Of points, or of their places.
struct LabelsOfRows {
  std::vector<std::uint32_t> item_of_row;
  formulas::SetLabels labels;

  std::vector<Estimates> of(std::span<const CloudPoint> points) const {
    std::vector<Estimates> made;
    for (const CloudPoint& p : points) {
      const std::int64_t number = labels.number[item_of_row[p.at.row]];
      const std::uint64_t size = number < 0 ? 0 : labels.size[static_cast<std::size_t>(number)];
      made.push_back({exact(static_cast<double>(number)), exact(static_cast<double>(size))});
    }
    return made;
  }
};

template <class ItemOf>
std::vector<std::uint32_t> items_of_rows(const SortedCloud& cloud, std::uint64_t rows, ItemOf item_of) {
  std::vector<std::uint32_t> items(rows);
  for (std::uint64_t row = 0; row < rows; ++row)
    if (const std::uint32_t point = cloud.point_of(row); point != SortedCloud::kNone) items[row] = item_of(point);
  return items;
}

constexpr std::uint64_t kSetBytes = 12 + 24;

class ComponentFormula final : public CloudFormula {
 public:
  explicit ComponentFormula(std::optional<double> distance) : distance_(distance) {}
  void prepare(const CloudInput& in) override {
    require_plain_neighbors(in);
    const SortedCloud cloud(in, {}, kSetBytes);
    JoinedSets sets(cloud.size());
    const double most2 = distance_ ? *distance_ * *distance_ : std::numeric_limits<double>::infinity();
    cloud.for_each_neighbor(in.neighborhood, [&](std::uint32_t i, std::uint32_t j, double d2) {
      if (d2 <= most2) sets.join(i, j);
    });
    found_.labels = formulas::labels_of(
        sets, cloud.size(), [](std::uint32_t) { return 1; }, [](std::uint32_t) { return true; });
    found_.item_of_row = items_of_rows(cloud, in.rows.count(), [](std::uint32_t point) { return point; });
  }
  std::vector<Estimates> evaluate(std::span<const CloudPoint> points, const CloudInput&) override {
    return found_.of(points);
  }

 private:
  std::optional<double> distance_;
  LabelsOfRows found_;
};

/// Points of one place are in one cluster, or all noise.
class ClusterFormula final : public CloudFormula {
 public:
  ClusterFormula(double eps2, std::optional<std::uint64_t> min_points) : eps2_(eps2), min_points_(min_points) {}
  void prepare(const CloudInput& in) override {
    require_plain_neighbors(in);
    if (!min_points_) throw NotTold("core points are not those of dbscan");
    const SortedCloud cloud(in, {}, kSetBytes);
    const std::uint32_t places = cloud.places();
    std::vector<bool> core(places);
    for (std::uint32_t p = 0; p < places; ++p) {
      std::uint64_t points = 0;
      cloud.tree().within(p, eps2_, [&](const auto& near) { points += cloud.points_at(near.place); });
      core[p] = points >= *min_points_;
    }
    JoinedSets sets(places);
    std::vector<bool> belongs = core;
    for (std::uint32_t p = 0; p < places; ++p) {
      std::optional<formulas::PlaceTree::Near> nearest;
      cloud.tree().within(p, eps2_, [&](const auto& near) {
        if (!core[near.place]) return;
        if (core[p])
          sets.join(p, near.place);
        else if (!nearest || near < *nearest)
          nearest = near;
      });
      if (nearest) sets.join(p, nearest->place), belongs[p] = true;
    }
    found_.labels = formulas::labels_of(
        sets, places, [&](std::uint32_t p) { return cloud.points_at(p); }, [&](std::uint32_t p) { return belongs[p]; });
    found_.item_of_row =
        items_of_rows(cloud, in.rows.count(), [&](std::uint32_t point) { return cloud.place_of(point); });
  }
  std::vector<Estimates> evaluate(std::span<const CloudPoint> points, const CloudInput&) override {
    return found_.of(points);
  }

 private:
  double eps2_;
  std::optional<std::uint64_t> min_points_;
  LabelsOfRows found_;
};

double product(const double* n, const double* m) { return n[0] * m[0] + n[1] * m[1] + n[2] * m[2]; }

class SegmentFormula final : public CloudFormula {
 public:
  SegmentFormula(double angle, std::optional<double> distance) : angle_(angle), distance_(distance) {}
  void prepare(const CloudInput& in) override {
    require_plain_neighbors(in);
    const std::array normals = {in.source(0)};
    const SortedCloud cloud(in, normals, kSetBytes);
    const double least = angle_ == 90 ? 0 : std::cos(angle_ * (std::numbers::pi / 180));
    const double most2 = distance_ ? *distance_ * *distance_ : std::numeric_limits<double>::infinity();
    JoinedSets sets(cloud.size());
    cloud.for_each_neighbor(in.neighborhood, [&](std::uint32_t i, std::uint32_t j, double d2) {
      if (std::fabs(product(cloud.values(i), cloud.values(j))) > least && d2 <= most2) sets.join(i, j);
    });
    found_.labels = formulas::labels_of(
        sets, cloud.size(), [](std::uint32_t) { return 1; }, [](std::uint32_t) { return true; });
    found_.item_of_row = items_of_rows(cloud, in.rows.count(), [](std::uint32_t point) { return point; });
  }
  std::vector<Estimates> evaluate(std::span<const CloudPoint> points, const CloudInput&) override {
    return found_.of(points);
  }

 private:
  double angle_;
  std::optional<double> distance_;
  LabelsOfRows found_;
};

struct WeightedEdge {
  double weight;
  std::uint32_t low, high;  ///< its points

  auto key() const { return std::tuple(weight, low, high); }
};

/// Kruskal's algorithm over all edges.
class SignFormula final : public CloudFormula {
 public:
  explicit SignFormula(std::optional<Vec3> viewpoint) : viewpoint_(viewpoint) {}
  void prepare(const CloudInput& in) override {
    require_plain_neighbors(in);
    const std::array normals = {in.source(0)};
    const std::uint64_t k = in.neighborhood.k == NeighborRule::kUnlimited ? 64 : in.neighborhood.k;
    const SortedCloud cloud(in, normals, kSetBytes + sizeof(formulas::TurningVotes) + k * sizeof(WeightedEdge));
    const std::uint64_t most_edges = in.rows.memory_bytes() / sizeof(WeightedEdge);
    std::vector<WeightedEdge> edges;
    cloud.for_each_neighbor(in.neighborhood, [&](std::uint32_t i, std::uint32_t j, double) {
      if (edges.size() == most_edges) throw NotTold("its edges need more than --memory");
      const double along = product(cloud.values(i), cloud.values(j));
      edges.push_back({std::isnan(along) ? 1 : 1 - std::fabs(along), std::min(i, j), std::max(i, j)});
    });
    std::ranges::sort(edges, {}, &WeightedEdge::key);
    JoinedSets sets(cloud.size());
    for (const WeightedEdge& e : edges)
      sets.join(e.low, e.high, product(cloud.values(e.low), cloud.values(e.high)) < 0);
    turn(cloud, sets, in.rows.count());
  }
  std::vector<Estimates> evaluate(std::span<const CloudPoint> points, const CloudInput&) override {
    std::vector<Estimates> made;
    for (const CloudPoint& p : points) {
      const std::int8_t turned = turned_[p.at.row];
      made.push_back({turned < 0 ? formulas::open() : exact(turned)});
    }
    return made;
  }

 private:
  void turn(const SortedCloud& cloud, JoinedSets& sets, std::uint64_t rows) {
    std::vector<formulas::TurningVotes> votes(cloud.size());
    const auto place = [&](std::uint32_t i) {
      const Vec3 p = cloud.position(i);
      return formulas::Vector{p.x, p.y, p.z};
    };
    std::optional<formulas::Vector> viewpoint;
    if (viewpoint_) viewpoint = {viewpoint_->x, viewpoint_->y, viewpoint_->z};
    for (std::uint32_t i = 0; i < cloud.size(); ++i) votes[sets.root(i).first].measure(place(i));
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
      const auto [root, flips] = sets.root(i);
      const double* n = cloud.values(i);
      const formulas::Vector normal{n[0], n[1], n[2]};
      votes[root].vote(place(i), flips ? formulas::Real{-1} * normal : normal, viewpoint);
    }
    turned_.assign(rows, 0);
    for (std::uint64_t row = 0; row < rows; ++row) {
      const std::uint32_t i = cloud.point_of(row);
      if (i == SortedCloud::kNone) continue;
      const auto [root, flips] = sets.root(i);
      const std::optional<bool> all = votes[root].turns(viewpoint_.has_value());
      turned_[row] = static_cast<std::int8_t>(all ? *all != flips : -1);
    }
  }

  std::optional<Vec3> viewpoint_;
  std::vector<std::int8_t> turned_;  ///< by row; -1: the data do not tell
};

}  // namespace

std::unique_ptr<CloudFormula> graph_formula_of(const ConnectedComponents& op) {
  return std::make_unique<ComponentFormula>(op.distance());
}

std::unique_ptr<CloudFormula> graph_formula_of(const ClustersOfCores& op, const CorePoints* cores) {
  const bool of_these = cores != nullptr && cores->eps() == op.eps();
  return std::make_unique<ClusterFormula>(op.eps() * op.eps(),
                                          of_these ? std::optional(cores->min_points()) : std::nullopt);
}

std::unique_ptr<CloudFormula> graph_formula_of(const Segments& op) {
  return std::make_unique<SegmentFormula>(op.angle(), op.distance());
}

std::unique_ptr<CloudFormula> graph_formula_of(const NormalSigns& op) {
  return std::make_unique<SignFormula>(op.viewpoint());
}

}  // namespace pointsweep
