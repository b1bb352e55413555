// SPDX-License-Identifier: MIT
#include "pointsweep/operators/segments.h"

#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include "pointsweep/fail.h"
#include "pointsweep/operators/connected_components.h"
#include "pointsweep/operators/declaration.h"

namespace pointsweep {
namespace {

std::shared_ptr<Operator> make_segments(const OptionValues& options, const Facts& facts) {
  std::optional<double> distance;
  if (options.given("distance")) distance = options.number("distance");
  return std::make_shared<Segments>(options.number("angle"), distance, facts.points);
}

}  // namespace

OperatorDeclaration segments_declaration() {
  return {.name = "segments",
          .meaning = "smooth segments: neighbours whose normals differ by less than an angle, with their sizes",
          .options = {{.name = "angle",
                       .kind = OptionKind::number,
                       .preset = 5.0,
                       .meaning = "normals of neighbours in one segment differ by less; above 0",
                       .least = 0,
                       .most = 90,
                       .unit = "degrees"},
                      {.name = "distance",
                       .kind = OptionKind::number,
                       .meaning = "points farther from each other are not joined",
                       .least = 0,
                       .unit = "length",
                       .sample = 0.5}},
          .make = make_segments,
          .formula =
              "Points i and j are joined if j is in N_i or i is in N_j, |n_i . n_j| > cos(angle), and with\n"
              "distance D |p_j - p_i| <= D. segment: components of these, numbered from 0 by the first point,\n"
              "that of the least x, then y, then z, then row. Normals are unit vectors or 0; a normal of 0 is\n"
              "joined with none.",
          .source =
              "after Rabbani, van den Heuvel, Vosselman, Segmentation of point clouds using smoothness constraint "
              "(ISPRS Archives XXXVI-5, 2006): its condition, without seeds and their order",
          .undefined = "-1, of size 0, for points without a finite place.",
          .cost = "a sweep that ends a pass; about 60 bytes a point in the temporary folder",
          .neighbor_ns = 12,
          .attributes = {{.name = "segment",
                          .meaning = "number of the smooth segment; undefined: -1",
                          .type = "i32, i64 from 2³¹ rows on"},
                         {.name = "segment_size",
                          .meaning = "points of the segment; undefined: 0",
                          .type = "u32, u64 from 2³¹ rows on"}},
          .example = "knn(k=12) | normals | segments(angle=5) | where(segment_size > 1000)"};
}

Segments::Segments(double angle, std::optional<double> distance, std::uint64_t points)
    : angle_(angle), distance_(distance), points_(points) {
  if (!(angle > 0 && angle <= 90)) fail_usage("segments: the angle {} is not above 0 and at most 90 degrees.", angle);
  if (distance && !(*distance >= 0 && std::isfinite(*distance)))
    fail_usage("segments: the distance {} is not a number of at least 0.", *distance);
}

Options Segments::own_options() const {
  Options options = {{"angle", angle_}};
  if (distance_) options.push_back({"distance", *distance_});
  return options;
}

Contract Segments::contract() const {
  return {{normal_attribute()},
          {normal_attribute()},
          {component_number("segment", "number of the smooth segment; -1 without a place", points_),
           component_size("segment_size", "points of the segment", points_)}};
}

void Segments::connect(const Neighborhoods& in, std::vector<NeighborEdge>& edges, std::byte*) const {
  const double least = angle_ == 90 ? 0 : std::cos(angle_ * (std::numbers::pi / 180));
  const double most2 = distance_ ? *distance_ * *distance_ : std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i < in.size(); ++i) {
    const Vec3 n = in.vector(0, i);
    const NeighborRef* neighbors = in.neighbors(i);
    for (std::size_t j = 0; j < in.count(i); ++j)
      if (std::abs(dot(n, in.vector_of(0, neighbors[j]))) > least && in.distance2(i, j) <= most2)
        edges.push_back({i, neighbors[j]});
  }
}

void Segments::put_values(const ComponentLabel& label, std::byte* values) const {
  put_component(label, has_short_numbers(points_), values);
}

}  // namespace pointsweep
