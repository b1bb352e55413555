// SPDX-License-Identifier: MIT
#include "pointsweep/operators/statistics/radius_outliers.h"

#include <cmath>
#include <memory>
#include <span>

#include "pointsweep/fail.h"
#include "pointsweep/operators/declare/complete_lists.h"
#include "pointsweep/operators/declare/declaration.h"
#include "pointsweep/operators/statistics/outliers.h"

namespace pointsweep {
namespace {

MadeStage make_ror(const OptionValues& options, const Facts& facts) {
  const double radius = options.number("radius");
  const std::uint64_t least = options.whole("min_neighbors");
  require_complete_lists(facts, static_cast<std::size_t>(least), radius, options.where());
  return std::make_shared<RadiusOutliers>(radius, least);
}

}  // namespace

OperatorDeclaration ror_declaration() {
  return {.name = "ror",
          .meaning = "radius outliers: points with fewer than min_neighbors neighbours within a radius",
          .options = {{.name = "radius",
                       .kind = OptionKind::number,
                       .meaning = "the distance within which neighbours count, inclusive",
                       .least = kAboveZero,
                       .unit = "length",
                       .required = true,
                       .sample = 0.5,
                       .is_radius = true},
                      {.name = "min_neighbors",
                       .kind = OptionKind::whole,
                       .preset = std::uint64_t{2},
                       .meaning = "number of neighbours that a point needs, without the point itself; knn needs k of "
                                  "at least this",
                       .least = 1}},
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

RadiusOutliers::RadiusOutliers(double radius, std::uint64_t min_neighbors)
    : radius_(radius), min_neighbors_(min_neighbors) {
  if (!(radius > 0 && std::isfinite(radius))) fail_usage("ror: the radius {} is not a number above 0.", radius);
  if (min_neighbors == 0) fail_usage("ror: min_neighbors = 0 makes no point an outlier; choose 1 or more.");
}

Contract RadiusOutliers::contract() const {
  Attribute outlier = outlier_attribute();
  outlier.meaning = "1: too few neighbours within the radius";
  return {.makes = {outlier}, .default_k = min_neighbors_};
}

void RadiusOutliers::apply(const Neighborhoods& in, Columns& out) const {
  const std::span<std::uint8_t> outlier = out.column<std::uint8_t>(0);
  const double radius2 = radius_ * radius_;
  for (std::size_t i = 0; i < in.size(); ++i) {
    std::uint64_t near = 0;
    for (std::size_t j = 0; j < in.count(i) && near < min_neighbors_; ++j) near += in.distance2(i, j) <= radius2;
    outlier[i] = near < min_neighbors_;
  }
}

}  // namespace pointsweep
