// SPDX-License-Identifier: MIT
/// `neighborhood_size` and `density`: the number of neighbours and the distance to the farthest neighbour, and the
/// number of points around a point for each unit of area and of volume.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>

#include "pointsweep/operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"

namespace pointsweep {
namespace {

/// Makes "neighbor_count", one uint32 per point: |N_i|, the point itself not counted; and "neighbor_radius", one
/// float64 per point: the distance to the farthest neighbour, in length units, at the current positions; 0 without
/// neighbours, NaN if a neighbour has no finite place. The values show what a rule of neighbourhoods has chosen, and
/// can be the k and the radius of a later run (PDAL stores them under the names OptimalKNN and OptimalRadius).
class NeighborhoodSize final : public LocalOperator {
 public:
  std::string name() const override { return "neighborhood_size"; }
  Contract contract() const override {
    return {{},
            {},
            {scalar("neighbor_count", Type::u32, "1", "number of neighbours"),
             scalar("neighbor_radius", Type::f64, "length", "distance to the farthest neighbour; 0 without any")}};
  }
  void apply(const Neighborhoods& in, Columns& out) const override {
    const std::span<std::uint32_t> count = out.column<std::uint32_t>(0);
    const std::span<double> radius = out.column<double>(1);
    for (std::size_t i = 0; i < in.size(); ++i) {
      count[i] = static_cast<std::uint32_t>(in.count(i));
      radius[i] = std::sqrt(in.farthest_distance2(i));
    }
  }
};

const OptionTable<DensityOptions>& density_options() {
  static const OptionTable<DensityOptions> table = {option(
      "radius", &DensityOptions::radius,
      "radius of the ball in which points are counted; without this option, the distance to the farthest neighbour",
      {.least = kAboveZero, .unit = "length", .sample = 0.5, .is_radius = true})};
  return table;
}

/// Converts a value >= 0 to float32. A value beyond the range of float32 becomes the largest float32.
float single(double v) { return static_cast<float>(std::min(v, double(std::numeric_limits<float>::max()))); }

struct Ball {
  double points = 0, radius = 0;
};

Ball ball_of(const Neighborhoods& in, std::size_t i, std::optional<double> radius) {
  if (!radius) return {static_cast<double>(in.count(i)), std::sqrt(in.farthest_distance2(i))};
  std::size_t near = 1;
  for (std::size_t j = 0; j < in.count(i); ++j) near += in.distance2(i, j) <= *radius * *radius;
  return {static_cast<double>(near), *radius};
}

/// Makes "surface_density" m / (π R²), points for each unit of area of a plane through the point, which cuts a disc of
/// radius R out of the ball; and "volume_density" m / (4/3 π R³). One float32 of each per point.
///   Without a radius: R is the distance to the farthest neighbour and m = |N_i|; the point itself is not counted.
///   With a radius: R is the radius, m the number of points within it, inclusive, the point itself counted, as in
///   CloudCompare. N_i must then include all points within the radius.
/// Positions are the current ones. Without a radius, both densities are 0 and the point counts as degenerate if R is 0,
/// there is no neighbour, or a neighbour has no finite place.
class Density final : public LocalOperator {
 public:
  /// Throws UsageError for options out of their ranges.
  explicit Density(const DensityOptions& options) : options_(options) { density_options().declare(*this, options); }
  std::string name() const override { return "density"; }
  Contract contract() const override {
    return {.makes = {scalar("surface_density", Type::f32, "1/length^2", "points for each unit of area"),
                      scalar("volume_density", Type::f32, "1/length^3", "points for each unit of volume")},
            .default_k = 32,
            .all_within = options_.radius};
  }
  void apply(const Neighborhoods& in, Columns& out) const override {
    const std::span<float> surface = out.column<float>(0), volume = out.column<float>(1);
    constexpr double pi = std::numbers::pi;
    for (std::size_t i = 0; i < in.size(); ++i) {
      const Ball ball = ball_of(in, i, options_.radius);
      const double r = ball.radius;
      if (!(r > 0 && std::isfinite(r))) {
        surface[i] = volume[i] = 0;
        out.mark_degenerate(i);
        continue;
      }
      // Dividing step by step keeps powers of R from overflow and underflow.
      surface[i] = single(ball.points / r / r / pi);
      volume[i] = single(ball.points / r / r / r / (4 * pi / 3));
    }
  }

 private:
  DensityOptions options_;
};

ChainStage make_density(const OptionValues& values, const Facts& facts) {
  const DensityOptions options = density_options().read(values);
  if (options.radius) require_complete_lists(facts, Neighborhood::kUnlimited, *options.radius, values.where());
  return std::make_shared<Density>(options);
}

}  // namespace

OperatorDeclaration neighborhood_size_declaration() {
  return {.name = "neighborhood_size",
          .meaning = "number of neighbours and distance of the farthest",
          .make = [](const OptionValues&, const Facts&) { return std::make_shared<NeighborhoodSize>(); },
          .formula = "|N_i| without p_i, and max_j |p_j - p_i|",
          .source = "PDAL keeps the same as OptimalKNN and OptimalRadius",
          .attributes = {{.name = "neighbor_count", .meaning = "how many neighbours the point has"},
                         {.name = "neighbor_radius",
                          .meaning = "distance to the farthest of them at the positions the stage sees; without any: "
                                     "0; if one has no finite place: NaN"}},
          .example = "knn(radius=0.1) | neighborhood_size"};
}

ChainStage operators::neighborhood_size() { return std::make_shared<NeighborhoodSize>(); }

OperatorDeclaration density_declaration() {
  return {
      .name = "density",
      .meaning = "points for each unit of area and of volume around a point",
      .options = density_options().declarations(),
      .make = make_density,
      .formula =
          "surface_density = m / (π R²), volume_density = m / (4/3 π R³)\n"
          "Without radius: R = max_j |p_j - p_i|, m = |N_i| without p_i.\n"
          "With radius R: m = 1 + |{j : |p_j - p_i| <= R}|, as CloudCompare counts; a knn before it has to hold all of "
          "these.\n"
          "A plane through p_i cuts a disc of area π R² out of the ball.",
      .source =
          "CloudCompare, Compute geometric features: surface and volume density; PDAL filters.radialdensity "
          "makes the volume density with radius",
      .undefined =
          "0 without neighbours, where all lie on the point, and where one has no finite place; with radius only "
          "for a point that has no finite place itself.",
      .degenerate = "have no neighbours, or only neighbours in the same place; their densities are 0",
      .neighbor_ns = 2,
      .attributes = {{.name = "surface_density", .meaning = "points for each unit of area; undefined: 0"},
                     {.name = "volume_density", .meaning = "points for each unit of volume; undefined: 0"}},
      .example = "knn(k=16) | density"};
}

ChainStage operators::density(const DensityOptions& options) { return std::make_shared<Density>(options); }

}  // namespace pointsweep
