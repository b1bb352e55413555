// SPDX-License-Identifier: MIT
/// Distances from one cloud to another.
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/in_order_operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"
#include "pointsweep/operators/kinds/results.h"
#include "pointsweep/operators/nearest/point_cells.h"

namespace pointsweep {
namespace {

/// Stores the other cloud in cells in the constructor, and finds the nearest of its points in add().
class DistanceToWork final : public InOrderWork {
 public:
  DistanceToWork(double most, const InOrderSetup& setup)
      : most2_(most * most), other_(PointCells::Space::all, setup.axis, setup.memory_bytes, setup.make_scratch()) {
    setup.other_points([&](const OtherPoints& points) { other_.add(points.positions, points.rows); });
    other_.finish();
  }

  void add(unsigned, const OrderedPoints& points, Findings& findings) override {
    std::vector<double> distances(points.rows.size(), std::numeric_limits<double>::quiet_NaN());
    other_.nearest_of_all(points.positions, {.most2 = most2_, .any_of_equal = true},
                          [&](std::size_t i, const std::vector<CellNeighbor>& nearest) {
                            if (!nearest.empty()) distances[i] = std::sqrt(nearest.front().distance2);
                          });
    add_findings(points.rows, std::as_bytes(std::span(distances)), findings);
  }

 private:
  double most2_;
  PointCells other_;
};

const OptionTable<DistanceToOptions>& distance_to_options() {
  static const OptionTable<DistanceToOptions> table = {
      option("cloud", &DistanceToOptions::cloud, "the other cloud: a point file, a folder of them or a pattern",
             {.kind = OptionKind::file, .required = true, .positional = true, .sample = "before.las"}),
      option("most", &DistanceToOptions::most,
             "maximum distance at which the nearest point is looked for; without this option there is no limit",
             {.least = kAboveZero, .unit = "length", .sample = 5.0, .is_radius = true})};
  return table;
}

/// Makes cloud_distance: the distance to the nearest point of another cloud, sqrt((dx² + dy²) + dz²) in float64; NaN if
/// no point is within DistanceToOptions::most.
class DistanceTo final : public InOrderOperator {
 public:
  /// Throws UsageError for options outside of their ranges.
  explicit DistanceTo(DistanceToOptions options) : options_(std::move(options)) {
    distance_to_options().declare(*this, options_);
  }

  std::string name() const override { return "distance_to"; }
  InOrderContract in_order_contract() const override {
    return {.makes = {nan_scalar("cloud_distance", "length", "distance to the nearest point of another cloud")},
            .places = Places::of_operator,
            .arrival = "beside those of the other cloud"};
  }
  std::unique_ptr<InOrderWork> start(const InOrderSetup& setup) const override {
    return std::make_unique<DistanceToWork>(most(), setup);
  }
  std::optional<Reach> reach() const override { return Reach{}; }
  std::optional<Reach> other_reach() const override { return Reach{.distance = most(), .nearest = 1}; }
  std::string other_cloud() const override { return options_.cloud; }
  std::uint64_t least_bytes(const CloudEstimate&) const override { return PointCells::least_bytes(); }

 private:
  double most() const { return options_.most.value_or(std::numeric_limits<double>::infinity()); }

  DistanceToOptions options_;
};

}  // namespace

OperatorDeclaration distance_to_declaration() {
  return {
      .name = "distance_to",
      .meaning = "measures the distance to the nearest point of another cloud",
      .options = distance_to_options().declarations(),
      .make = distance_to_options().maker<DistanceTo>(),
      .formula = "d = min_j sqrt((dx² + dy²) + dz²) over the points j of the other cloud, in float64",
      .source =
          "Cloud-to-cloud distance: Girardeau-Montaut, Roux, Marc and Thibault, Change detection on points cloud data "
          "acquired with a ground laser scanner (ISPRS 2005)",
      .undefined = "NaN where no point of the other cloud is within `most`, and for points without a finite place.",
      .cost =
          "a pass that puts the points in order along an axis; the other cloud is put in the same order in the "
          "temporary folder (32 bytes a point, and as much while it is ordered), and memory holds what is near the "
          "front",
      .attributes = {{.name = "cloud_distance",
                      .meaning = "distance to the nearest point of the other cloud; undefined: NaN"}},
      .example = "distance_to(before.las, most=5) | where(cloud_distance > 0.1)"};
}

ChainStage operators::distance_to(const DistanceToOptions& options) { return std::make_shared<DistanceTo>(options); }

}  // namespace pointsweep
