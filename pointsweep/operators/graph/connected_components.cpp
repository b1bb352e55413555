// SPDX-License-Identifier: MIT
/// Connected components of the graph of neighbours.
#include <memory>
#include <optional>
#include <vector>

#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"
#include "pointsweep/operators/kinds/connect_operator.h"

namespace pointsweep {
namespace {

const OptionTable<ComponentsOptions>& components_options() {
  static const OptionTable<ComponentsOptions> table = {
      option("distance", &ComponentsOptions::distance,
             "points farther from each other are not joined; a knn before it has to hold all points within it",
             {.unit = "length", .sample = 0.5, .is_radius = true})};
  return table;
}

/// Makes component and component_size. Points i and j are joined if one is a neighbour of the other, and their distance
/// does not exceed ComponentsOptions::distance, if that option is set. Components are numbered from 0 in the order of
/// their first points, by x, then y, then z, then row.
class ConnectedComponents final : public ConnectOperator {
 public:
  /// With a distance, the neighbours N_i of a point must include all points within the distance. Pipelines without such
  /// neighbourhoods are refused; C++ callers must provide them. `points`: number of points of the cloud for
  /// has_short_numbers(). Throws UsageError for options outside of their ranges.
  explicit ConnectedComponents(const ComponentsOptions& options, std::uint64_t points = 0)
      : distance_(options.distance), points_(points) {
    components_options().declare(*this, options);
  }
  std::string name() const override { return "components"; }
  Contract contract() const override {
    return {.makes = {component_number("component", "number of the connected component; -1 without a place", points_),
                      component_size("component_size", "points of the connected component", points_)},
            .all_within = distance_};
  }
  /// Without a distance, a point emits an edge to each of its neighbours. With a distance, the two ends of an edge are
  /// neighbours of each other, so only the end with the lower row emits the edge.
  void connect(const Neighborhoods& in, std::vector<NeighborEdge>& edges, std::byte*) const override {
    for (std::uint32_t i = 0; i < in.size(); ++i) {
      const NeighborRef* neighbors = in.neighbors(i);
      for (std::size_t j = 0; j < in.count(i); ++j) {
        if (distance_ && (in.neighbor_row(i, j) < in.row(i) || !(in.distance2(i, j) <= *distance_ * *distance_)))
          continue;
        edges.push_back({i, neighbors[j]});
      }
    }
  }
  void put_values(const ComponentLabel& label, std::byte* values) const override {
    put_component(label, has_short_numbers(points_), values);
  }

 private:
  std::optional<double> distance_;
  std::uint64_t points_;
};

ChainStage make_components(const OptionValues& values, const Facts& facts) {
  const ComponentsOptions options = components_options().read(values);
  if (options.distance) require_complete_lists(facts, Neighborhood::kUnlimited, *options.distance, values.where());
  return std::make_shared<ConnectedComponents>(options, facts.points);
}

}  // namespace

OperatorDeclaration components_declaration() {
  return {
      .name = "components",
      .meaning = "connected components of the graph of neighbours, with their sizes",
      .options = components_options().declarations(),
      .make = make_components,
      .formula =
          "Points i and j are joined if j is in N_i or i is in N_j; with distance D: if |p_j - p_i| <= D.\n"
          "component: numbered from 0 by the first point, that of the least x, then y, then z, then row.",
      .source = "exact minimum spanning forest of the open points, docs/adr/0014",
      .undefined = "-1, of size 0, for points without a finite place.",
      .cost = "a sweep that ends a pass; about 60 bytes a point in the temporary folder",
      .neighbor_ns = 10,
      .attributes =
          {{.name = "component", .meaning = "number of the connected component; undefined: -1", .type = kNumberTypes},
           {.name = "component_size", .meaning = "points of the component; undefined: 0", .type = kSizeTypes}},
      .example = "knn(k=8) | components | where(component_size > 100)"};
}

ChainStage operators::components(const ComponentsOptions& options) {
  return std::make_shared<ConnectedComponents>(options);
}

}  // namespace pointsweep
