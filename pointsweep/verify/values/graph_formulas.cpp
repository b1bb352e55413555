// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <tuple>

#include "pointsweep/verify/values/label_formula.h"
#include "pointsweep/verify/values/sorted_cloud.h"

namespace pointsweep {
namespace {

using formulas::Estimate;
using formulas::exactly;
using formulas::JoinedSets;
using formulas::Real;

template <class ItemOf>
std::vector<std::uint32_t> items_of_rows(const SortedCloud& cloud, std::uint64_t rows, ItemOf item_of) {
  std::vector<std::uint32_t> items(rows);
  for (std::uint64_t row = 0; row < rows; ++row)
    if (const std::uint32_t point = cloud.point_of(row); point != SortedCloud::kNone) items[row] = item_of(point);
  return items;
}

constexpr std::uint64_t kSetBytes = 12 + 24;

/// Returns the square of option `distance`; infinite without the option.
double most_distance2(const FormulaSetup& stage) {
  const std::optional<double> most = stage.options.number_if_given("distance");
  return most ? *most * *most : std::numeric_limits<double>::infinity();
}

LabelsOfRows labels_of_points(const SortedCloud& cloud, JoinedSets& sets, std::uint64_t rows) {
  const auto one = [](std::uint32_t) { return 1; };
  const auto all = [](std::uint32_t) { return true; };
  return {items_of_rows(cloud, rows, [](std::uint32_t point) { return point; }),
          formulas::labels_of(sets, cloud.size(), one, all)};
}

class ComponentFormula final : public LabelFormula {
 public:
  explicit ComponentFormula(const FormulaSetup& stage) : most2_(most_distance2(stage)) {}

 private:
  LabelsOfRows labels(const CloudInput& in) const override {
    const SortedCloud cloud(in, {}, kSetBytes);
    JoinedSets sets(cloud.size());
    cloud.for_each_neighbor(in.neighborhood, [&](std::uint32_t i, std::uint32_t j, double d2) {
      if (d2 <= most2_) sets.join(i, j);
    });
    return labels_of_points(cloud, sets, in.rows.count());
  }
  std::vector<ColumnSource> columns(const CloudInput&) const override { return {}; }
  Join joined(std::span<const double>, std::span<const double>, double d2) const override {
    return d2 <= most2_ ? Join::yes : Join::no;
  }

  double most2_;
};

/// The formula of clusters. Points at one place are in one cluster, or all are noise.
class ClusterFormula final : public LabelFormula {
 public:
  explicit ClusterFormula(const FormulaSetup& stage) : eps2_(square(stage.options.number("eps"))) {
    const Operator* const maker = stage.makers[0];
    if (maker == nullptr || maker->name() != "core") return;
    const NamedOptions cores = setup_of(*maker).options;
    if (square(cores.number("eps")) == eps2_) min_points_ = cores.whole("min_points");
  }

 private:
  LabelsOfRows labels(const CloudInput& in) const override {
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
      std::optional<PlaceTree::Near> nearest;
      cloud.tree().within(p, eps2_, [&](const auto& near) {
        if (!core[near.place]) return;
        if (core[p])
          sets.join(p, near.place);
        else if (!nearest || near < *nearest)
          nearest = near;
      });
      if (nearest) sets.join(p, nearest->place), belongs[p] = true;
    }
    const auto points_at = [&](std::uint32_t p) { return cloud.points_at(p); };
    const auto counts = [&](std::uint32_t p) { return static_cast<bool>(belongs[p]); };
    return {items_of_rows(cloud, in.rows.count(), [&](std::uint32_t point) { return cloud.place_of(point); }),
            formulas::labels_of(sets, places, points_at, counts)};
  }
  /// Returns the column of the attribute that is 1 for core points and 0 for others.
  std::vector<ColumnSource> columns(const CloudInput& in) const override { return {in.source(0)}; }
  Join joined(std::span<const double> point, std::span<const double> neighbor, double d2) const override {
    if (!(d2 <= eps2_) || neighbor[0] == 0) return Join::no;
    return point[0] != 0 ? Join::yes : Join::as_first;
  }
  Estimate alone(std::span<const double> point) const override {
    return point[0] != 0 ? formulas::open() : exactly(-1);
  }

  static double square(double v) { return v * v; }

  double eps2_;
  std::optional<std::uint64_t> min_points_;  ///< absent if another stage makes the core points
};

double product(const double* n, const double* m) { return n[0] * m[0] + n[1] * m[1] + n[2] * m[2]; }

/// Returns `segments`, by number, with the flatness of the points of each segment, measured in two passes over all
/// rows. number_of(row, values of the columns) returns the segment of a row.
template <class NumberOf>
std::map<std::int64_t, formulas::Flatness> flatness_of(std::map<std::int64_t, formulas::Flatness> segments,
                                                       const CloudInput& in, std::span<const ColumnSource> columns,
                                                       NumberOf number_of) {
  const auto look = [&](const auto& use) {
    in.rows.for_each(columns, [&](std::uint64_t row, Vec3 p, std::span<const double> values) {
      if (!is_finite(p)) return;
      const auto segment = segments.find(number_of(row, values));
      if (segment != segments.end()) use(segment->second, formulas::Vector{p.x, p.y, p.z});
    });
  };
  look([](formulas::Flatness& f, formulas::Vector p) { f.measure(p); });
  look([](formulas::Flatness& f, formulas::Vector p) { f.add(p); });
  return segments;
}

/// The formula of segments. If the whole graph does not fit in memory, the residual is computed from the points with
/// the same number in the output.
class SegmentFormula final : public LabelFormula {
 public:
  std::vector<Estimates> evaluate(std::span<const CloudPoint> points, const CloudInput& in) override {
    std::vector<Estimates> made = LabelFormula::evaluate(points, in);
    const auto number = [](const Estimate& e) { return e.is_open() ? -1 : static_cast<std::int64_t>(e.value.x); };
    std::map<std::int64_t, formulas::Flatness> segments;
    for (const Estimates& e : made) segments[number(e[0])];
    segments.erase(-1);
    if (is_found())
      segments = flatness_of(std::move(segments), in, {},
                             [&](std::uint64_t row, auto) { return found().labels.number[found().item_of_row[row]]; });
    else
      segments = flatness_of(std::move(segments), in, label_columns(in),
                             [](std::uint64_t, auto values) { return static_cast<std::int64_t>(values[0]); });
    for (Estimates& e : made) {
      const auto known = segments.find(number(e[0]));
      e.push_back(known == segments.end() ? formulas::open() : known->second.residual());
    }
    return made;
  }

  explicit SegmentFormula(const FormulaSetup& stage)
      : least_(least_product(stage.options.number("angle"))), most2_(most_distance2(stage)) {}

 private:
  LabelsOfRows labels(const CloudInput& in) const override {
    const std::array normals = {in.source(0)};
    const SortedCloud cloud(in, normals, kSetBytes);
    JoinedSets sets(cloud.size());
    cloud.for_each_neighbor(in.neighborhood, [&](std::uint32_t i, std::uint32_t j, double d2) {
      if (are_joined(cloud.values(i), cloud.values(j), d2)) sets.join(i, j);
    });
    return labels_of_points(cloud, sets, in.rows.count());
  }
  std::vector<ColumnSource> columns(const CloudInput& in) const override { return {in.source(0)}; }
  Join joined(std::span<const double> point, std::span<const double> neighbor, double d2) const override {
    return are_joined(point.data(), neighbor.data(), d2) ? Join::yes : Join::no;
  }
  static double least_product(double angle) { return angle == 90 ? 0 : std::cos(angle * (std::numbers::pi / 180)); }
  bool are_joined(const double* n, const double* m, double d2) const {
    return std::fabs(product(n, m)) > least_ && d2 <= most2_;
  }

  double least_, most2_;
};

struct WeightedEdge {
  double weight;
  std::uint32_t low, high;  ///< numbers of the points of the edge

  auto key() const { return std::tuple(weight, low, high); }
};

/// The formula of the signs of normals: Kruskal's algorithm over all edges.
class SignFormula final : public CloudFormula {
 public:
  explicit SignFormula(const FormulaSetup& stage) {
    if (stage.options.has("viewpoint")) viewpoint_ = stage.options.point("viewpoint");
  }
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
      made.push_back({turned < 0 ? formulas::open() : exactly(turned)});
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
      votes[root].vote(place(i), flips ? Real{-1} * normal : normal, viewpoint);
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
  std::vector<std::int8_t> turned_;  ///< for each row, 1 if the normal is turned and 0 if not; -1 if undecided
};

}  // namespace

std::vector<NamedCloudFormula> graph_formulas() {
  return {{"components", cloud_formula_made<ComponentFormula>},
          {"clusters", cloud_formula_made<ClusterFormula>},
          {"segments", cloud_formula_made<SegmentFormula>},
          {"normal_signs", cloud_formula_made<SignFormula>}};
}

}  // namespace pointsweep
