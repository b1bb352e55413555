// SPDX-License-Identifier: MIT
#include "pointsweep/operators/graph/segments.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <numbers>

#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"
#include "pointsweep/operators/graph/connected_components.h"

namespace pointsweep {
namespace {

const OptionTable<SegmentsOptions>& segments_options() {
  static const OptionTable<SegmentsOptions> table = {
      option("angle", &SegmentsOptions::angle, "maximum angle between the normals of neighbours in one segment",
             {.least = kAboveZero, .most = 90, .unit = "degrees"}),
      option("distance", &SegmentsOptions::distance, "points farther from each other are not joined",
             {.unit = "length", .sample = 0.5, .is_radius = true})};
  return table;
}

ChainStage make_segments(const OptionValues& values, const Facts& facts) {
  return std::make_shared<Segments>(segments_options().read(values), facts.points);
}

Attribute residual_attribute() {
  Attribute residual = scalar("segment_residual", Type::f32, "length",
                              "root mean square distance of the segment's points to their plane; NaN without a place");
  residual.fill = std::byte{0xff};  // NaN
  return residual;
}

}  // namespace

OperatorDeclaration segments_declaration() {
  return {
      .name = "segments",
      .meaning = "smooth segments: neighbours whose normals differ by less than an angle, with sizes and flatness",
      .options = segments_options().declarations(),
      .make = make_segments,
      .formula =
          "Points i and j are joined if j is in N_i or i is in N_j, |n_i . n_j| > cos(angle), and with "
          "distance D |p_j - p_i| <= D. segment: components of these, numbered from 0 by the first point, "
          "that of the least x, then y, then z, then row. Normals are unit vectors or 0; a normal of 0 is "
          "joined with none.\n"
          "segment_residual: the root mean square distance of the points of the segment to the plane for "
          "which it is least: the square root of the least eigenvalue of their covariance; 0 for fewer than "
          "4 points. Positions count in steps of 2^-40, up to 2^40, and their sums are exact; the error of the "
          "residual is below 10^-7 of the extent of the segment, or 2^-40 where that is more.",
      .source =
          "after Rabbani, van den Heuvel, Vosselman, Segmentation of point clouds using smoothness constraint "
          "(ISPRS Archives XXXVI-5, 2006): its condition, without seeds and their order",
      .undefined = "-1, of size 0, with a residual of NaN, for points without a finite place.",
      .cost =
          "a sweep that ends a pass; 70 to 90 bytes a point in the temporary folder, 120 beside attributes that the "
          "same sweep makes",
      .neighbor_ns = 12,
      .attributes = {{.name = "segment",
                      .meaning = "number of the smooth segment; undefined: -1",
                      .type = "i32, i64 from 2³¹ rows on"},
                     {.name = "segment_size",
                      .meaning = "points of the segment; undefined: 0",
                      .type = "u32, u64 from 2³¹ rows on"},
                     {.name = "segment_residual",
                      .meaning = "root mean square distance of the segment's points to their plane; undefined: NaN"}},
      .example = "knn(k=12) | normals | segments(angle=5) | where(segment_size > 1000)"};
}

ChainStage operators::segments(const SegmentsOptions& options) { return std::make_shared<Segments>(options); }

Segments::Segments(const SegmentsOptions& options, std::uint64_t points) : options_(options), points_(points) {
  segments_options().declare(*this, options);
}

Contract Segments::contract() const {
  return {.reads = {normal_attribute()},
          .reads_neighbors = {normal_attribute()},
          .makes = {component_number("segment", "number of the smooth segment; -1 without a place", points_),
                    component_size("segment_size", "points of the segment", points_), residual_attribute()},
          .default_k = 16};
}

std::shared_ptr<const ConnectOperator> Segments::bound(const Schema&, std::span<const Attribute> made) const {
  if (std::ranges::find(made, position_attribute().name, &Attribute::name) == made.end()) return nullptr;
  auto bound = std::make_shared<Segments>(*this);
  bound->residual_ = PlaneResidual(true);
  return bound;
}

void Segments::connect(const Neighborhoods& in, std::vector<NeighborEdge>& edges, std::byte* ballots) const {
  const double least = options_.angle == 90 ? 0 : std::cos(options_.angle * (std::numbers::pi / 180));
  const double most2 =
      options_.distance ? *options_.distance * *options_.distance : std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i < in.size(); ++i) {
    if (residual_.ballot_bytes() > 0) {
      const Vec3 place = in.position(i);
      std::memcpy(ballots + i * sizeof place, &place, sizeof place);
    }
    const Vec3 n = in.vector(0, i);
    const NeighborRef* neighbors = in.neighbors(i);
    for (std::size_t j = 0; j < in.count(i); ++j)
      if (std::abs(dot(n, in.vector_of(0, neighbors[j]))) > least && in.distance2(i, j) <= most2)
        edges.push_back({i, neighbors[j]});
  }
}

void Segments::put_values(const ComponentLabel& label, std::byte* values) const {
  const bool is_short = has_short_numbers(points_);
  put_component(label, is_short, values);
  std::memcpy(values + (is_short ? 8 : 16), label.result, residual_.result_bytes());
}

}  // namespace pointsweep
