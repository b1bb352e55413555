// SPDX-License-Identifier: MIT
/// Radius outliers: points with few neighbours near them (filters.outlier, method radius, of PDAL; RadiusOutlierRemoval
/// of PCL; remove_radius_outlier of Open3D).
#include <memory>
#include <span>
#include <string>

#include "pointsweep/operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"
#include "pointsweep/operators/statistics/outliers.h"

namespace pointsweep {
namespace {

const OptionTable<RorOptions>& ror_options() {
  static const OptionTable<RorOptions> table = {
      option("radius", &RorOptions::radius, "the distance within which neighbours count, inclusive",
             {.least = kAboveZero, .unit = "length", .required = true, .sample = 0.5, .is_radius = true}),
      option("min_neighbors", &RorOptions::min_neighbors,
             "number of neighbours that a point needs, without the point itself; knn needs k of at least this",
             {.least = 1})};
  return table;
}

/// Makes outlier, one uint8 per point: 1 if fewer than `min_neighbors` neighbours lie within `radius`, inclusive, of
/// the point, at the current positions; else 0. The neighbours N_i of a point must include all points within the
/// radius, or the min_neighbors nearest of them: the k of the neighbourhoods must be at least min_neighbors, and their
/// radius at least `radius`. Pipelines without such neighbourhoods are refused; C++ callers must provide them.
class RadiusOutliers final : public LocalOperator {
 public:
  /// Throws UsageError for options out of their ranges.
  explicit RadiusOutliers(const RorOptions& options) : options_(options) { ror_options().declare(*this, options); }
  std::string name() const override { return "ror"; }
  Contract contract() const override {
    Attribute outlier = outlier_attribute();
    outlier.meaning = "1: too few neighbours within the radius";
    return {.makes = {outlier}, .default_k = options_.min_neighbors};
  }
  void apply(const Neighborhoods& in, Columns& out) const override {
    const std::span<std::uint8_t> outlier = out.column<std::uint8_t>(0);
    const double radius2 = options_.radius * options_.radius;
    for (std::size_t i = 0; i < in.size(); ++i) {
      std::uint64_t near = 0;
      for (std::size_t j = 0; j < in.count(i) && near < options_.min_neighbors; ++j)
        near += in.distance2(i, j) <= radius2;
      outlier[i] = near < options_.min_neighbors;
    }
  }

 private:
  RorOptions options_;
};

ChainStage make_ror(const OptionValues& values, const Facts& facts) {
  const RorOptions options = ror_options().read(values);
  require_complete_lists(facts, options.min_neighbors, options.radius, values.where());
  return std::make_shared<RadiusOutliers>(options);
}

}  // namespace

OperatorDeclaration ror_declaration() {
  return {.name = "ror",
          .meaning = "radius outliers: points with fewer than min_neighbors neighbours within a radius",
          .options = ror_options().declarations(),
          .make = make_ror,
          .formula =
              "outlier = 1 where |{j in N_i : |p_j - p_i| <= radius}| < min_neighbors, N_i without p_i.\n"
              "The min_neighbors nearest neighbours are enough to know, so that knn(k=min_neighbors) before it "
              "makes the same as knn(radius=...) in less time.\n"
              "PDAL (min_k), PCL (setMinNeighborsInRadius) and Open3D (nb_points) keep the same points, except "
              "that PDAL and Open3D do not count a neighbour at exactly the radius.",
          .source = "PDAL filters.outlier, method radius; PCL RadiusOutlierRemoval; Open3D remove_radius_outlier",
          .undefined =
              "A neighbour that has no finite place is not within the radius. A point that has none is an outlier.",
          .neighbor_ns = 2,
          .attributes = {{.name = "outlier",
                          .meaning = "1: fewer than min_neighbors neighbours within the radius; else 0"}},
          .example = "knn(k=4) | ror(radius=0.5, min_neighbors=4) | where(outlier == 0)"};
}

ChainStage operators::ror(const RorOptions& options) { return std::make_shared<RadiusOutliers>(options); }

}  // namespace pointsweep
