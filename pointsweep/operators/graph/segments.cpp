// SPDX-License-Identifier: MIT
/// Segments: parts of a surface across which normals turn little from neighbour to neighbour. Segments resemble the
/// regions of region growing, but do not depend on seeds or their order (T. Rabbani, F. van den Heuvel, G. Vosselman,
/// "Segmentation of point clouds using smoothness constraint", 2006).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/connect/forest_log.h"
#include "pointsweep/math/exact_sum.h"
#include "pointsweep/math/symmetric3.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"
#include "pointsweep/operators/expressions/named_values.h"
#include "pointsweep/operators/kinds/connect_operator.h"
#include "pointsweep/operators/kinds/results.h"

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

constexpr double kUnits = 0x1p40, kFarthestPlace = 0x1p40;
constexpr std::array<std::array<std::size_t, 2>, 6> kEntries = {{{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}}};

/// Sums over points with positions q, whole numbers of units of 2^-40.
struct Moments {
  std::array<Int192, 6> second;  ///< Σ q_a q_b for the pairs (a, b) in kEntries
  std::array<Int128, 3> first;   ///< Σ q_a
  std::uint64_t points, placed;  ///< `placed`: number of points with finite places, which alone are in the sums
};

Moments moments_at(const std::byte* bytes) {
  Moments moments;
  std::memcpy(&moments, bytes, sizeof moments);
  return moments;
}

/// Returns Σ (q_a - c_a)(q_b - c_b) / n with the mean c, for points that all have finite places. m is c without its
/// fraction. Σ (q_a - m_a)(q_b - m_b) is an exact integer. That integer exceeds Σ (q_a - c_a)(q_b - c_b) by r_a r_b /
/// n, with r = Σ q - n m; r is below n in magnitude, so float64 suffices for r_a r_b / n.
Symmetric3 covariance(const Moments& sums) {
  const auto n = static_cast<Int128>(sums.points);
  std::array<Int128, 3> mean, rest;
  for (std::size_t a = 0; a < 3; ++a) {
    mean[a] = sums.first[a] / n;
    rest[a] = sums.first[a] - n * mean[a];
  }
  std::array<double, 6> entry;
  const auto points = static_cast<double>(sums.points);
  for (std::size_t e = 0; e < 6; ++e) {
    const auto [a, b] = kEntries[e];
    const Int192 around = sums.second[e] - Int192::product(mean[a], sums.first[b]) - Int192::product(mean[b], rest[a]);
    const double off = static_cast<double>(rest[a]) * static_cast<double>(rest[b]) / points;
    entry[e] = (static_cast<double>(around) - off) / points;
  }
  return {entry[0], entry[1], entry[2], entry[3], entry[4], entry[5]};
}

float residual(const Moments& sums) {
  if (sums.placed < sums.points) return std::numeric_limits<float>::quiet_NaN();
  if (sums.points < 4) return 0;
  const double least = eigen_symmetric3(covariance(sums)).value[0];
  return static_cast<float>(std::sqrt(std::max(0.0, least)) / kUnits);
}

/// The root mean square distance of points to their best plane: the square root of the least eigenvalue of their
/// covariance. Positions are limited to 2^40 in absolute value and rounded to multiples of 2^-40, so that sums are
/// exact integers. Later steps are in float64, which determines an eigenvalue to about 2^-50 of the largest, and the
/// result is float32. So the error is below 10^-7 of the extent of the component, or below 2^-40 if 2^-40 is larger.
/// The residual is NaN if a point has no finite place; otherwise that of fewer than four points is 0.
class PlaneResidual final : public VoteRule {
 public:
  /// `moved`: true if a ballot is the moved position of a point, three float64. Otherwise ballots are empty, and the
  /// position in the key of the point counts.
  explicit PlaneResidual(bool moved) : moved_(moved) {}
  std::size_t ballot_bytes() const override { return moved_ ? 3 * sizeof(double) : 0; }
  std::size_t bytes() const override { return sizeof(Moments); }
  void start(std::byte* votes, const PointKey& point, const std::byte* ballot) const override {
    Vec3 place = point.position;
    if (moved_) std::memcpy(&place, ballot, sizeof place);
    Moments sums{.second = {}, .first = {}, .points = 1, .placed = is_finite(place) ? 1u : 0u};
    if (sums.placed == 1) {
      for (int a = 0; a < 3; ++a)
        sums.first[a] =
            static_cast<Int128>(std::nearbyint(std::clamp(place[a], -kFarthestPlace, kFarthestPlace) * kUnits));
      for (std::size_t e = 0; e < 6; ++e)
        sums.second[e] = Int192::product(sums.first[kEntries[e][0]], sums.first[kEntries[e][1]]);
    }
    std::memcpy(votes, &sums, sizeof sums);
  }
  void merge(std::byte* into, const std::byte* from, bool) const override {
    Moments sums = moments_at(into);
    const Moments more = moments_at(from);
    for (std::size_t e = 0; e < 6; ++e) sums.second[e] += more.second[e];
    for (std::size_t a = 0; a < 3; ++a) sums.first[a] += more.first[a];
    sums.points += more.points;
    sums.placed += more.placed;
    std::memcpy(into, &sums, sizeof sums);
  }
  /// Returns the size of the result: one float32, NaN if a point has no finite place.
  std::size_t result_bytes() const override { return sizeof(float); }
  void conclude(const std::byte* votes, std::byte* result) const override {
    const float value = residual(moments_at(votes));
    std::memcpy(result, &value, sizeof value);
  }

 private:
  bool moved_;
};

/// Makes segment, segment_size and segment_residual: components of the points that are joined if one is a neighbour of
/// the other, their normals differ by less than an angle, whatever their signs, and their distance is at most
/// SegmentsOptions::distance, if that is set. A point without a normal is a segment of one point. PlaneResidual
/// measures how flat segments are.
class Segments final : public ConnectOperator {
 public:
  /// Throws UsageError for options out of their ranges. `points`: points of the cloud for has_short_numbers().
  explicit Segments(const SegmentsOptions& options, std::uint64_t points = 0) : options_(options), points_(points) {
    segments_options().declare(*this, options);
  }
  std::string name() const override { return "segments"; }
  Contract contract() const override {
    return {
        .reads = {normal_attribute()},
        .reads_neighbors = {normal_attribute()},
        .makes = {component_number("segment", "number of the smooth segment; -1 without a place", points_),
                  component_size("segment_size", "points of the segment", points_),
                  nan_scalar("segment_residual", "length",
                             "root mean square distance of the segment's points to their plane; NaN without a place",
                             Type::f32)},
        .default_k = 16};
  }
  const VoteRule* votes() const override { return &residual_; }
  /// Returns an operator that computes the residual from the moved points, if an earlier stage moves points; else null.
  std::shared_ptr<const ConnectOperator> bound(const Schema&, std::span<const Attribute> made) const override {
    if (!makes(made, position_attribute().name)) return nullptr;
    auto bound = std::make_shared<Segments>(*this);
    bound->residual_ = PlaneResidual(true);
    return bound;
  }
  void connect(const Neighborhoods& in, std::vector<NeighborEdge>& edges, std::byte* ballots) const override {
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
  void put_values(const ComponentLabel& label, std::byte* values) const override {
    const bool is_short = has_short_numbers(points_);
    put_component(label, is_short, values);
    std::memcpy(values + (is_short ? 8 : 16), label.result, residual_.result_bytes());
  }

 private:
  SegmentsOptions options_;
  std::uint64_t points_;
  PlaneResidual residual_{false};
};

ChainStage make_segments(const OptionValues& values, const Facts& facts) {
  return std::make_shared<Segments>(segments_options().read(values), facts.points);
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
                      .type = kNumberTypes},
                     {.name = "segment_size", .meaning = "points of the segment; undefined: 0", .type = kSizeTypes},
                     {.name = "segment_residual",
                      .meaning = "root mean square distance of the segment's points to their plane; undefined: NaN"}},
      .example = "knn(k=12) | normals | segments(angle=5) | where(segment_size > 1000)"};
}

ChainStage operators::segments(const SegmentsOptions& options) { return std::make_shared<Segments>(options); }

}  // namespace pointsweep
