// SPDX-License-Identifier: MIT
/// Changes between two clouds along normals: multiscale model to model cloud comparison.
#include <algorithm>
#include <array>
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

/// Number of points that a thread compares at a time, with one PointCells::View.
constexpr std::size_t kPointsAtOnce = 256;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Statistics of the points of one cloud inside a cylinder: mean and standard deviation (n - 1) of their coordinates
/// along its axis, and their number n. The mean of none, and the deviation of fewer than two, are NaN.
struct Section {
  double mean = kUnknown, spread = kUnknown;
  std::size_t count = 0;
};

/// Returns the statistics of the coordinates `along`, which it sorts: sums from the least to the greatest value do not
/// depend on the order of the points.
Section section_of(std::vector<double>& along) {
  std::ranges::sort(along);
  Section section{.count = along.size()};
  const auto n = static_cast<double>(along.size());
  if (along.empty()) return section;
  double sum = 0, squares = 0;
  for (const double a : along) sum += a;
  section.mean = sum / n;
  if (along.size() == 1) return section;
  for (const double a : along) squares += (a - section.mean) * (a - section.mean);
  section.spread = std::sqrt(squares / (n - 1));
  return section;
}

/// A cylinder along a normal, which reaches `depth` to each side of its centre.
class Cylinder {
 public:
  Cylinder(Vec3 center, Vec3 normal, double diameter, double depth)
      : center_(center), axis_((1 / length(normal)) * normal), radius_(diameter / 2), depth_(depth) {}

  /// Returns a box around the cylinder, slightly larger than necessary.
  Box box() const {
    Vec3 half;
    for (int a = 0; a < 3; ++a) {
      const double across = std::sqrt(std::max(0.0, 1 - axis_[a] * axis_[a]));
      half[a] = (depth_ * std::abs(axis_[a]) + radius_ * across) * (1 + 1e-9) + 1e-12 * std::abs(center_[a]);
    }
    return {center_ - half, center_ + half};
  }
  /// Returns the coordinate of a point along the axis, or nothing if the point is outside of the cylinder.
  std::optional<double> along(Vec3 point) const {
    const Vec3 offset = point - center_;
    const double a = dot(offset, axis_);
    const Vec3 aside = cross(offset, axis_);
    if (std::abs(a) > depth_ || dot(aside, aside) > radius_ * radius_) return std::nullopt;
    return a;
  }

 private:
  Vec3 center_, axis_;
  double radius_, depth_;
};

/// Stores the points of the chain's cloud in cells in the first round, and compares them with both clouds in the
/// second. The constructor stores the points of the other cloud.
class M3c2Work final : public InOrderWork {
 public:
  M3c2Work(const M3c2Options& options, const InOrderSetup& setup)
      : options_(options), own_(cells(setup)), other_(cells(setup)) {
    setup.other_points([&](const OtherPoints& points) { other_.add(points.positions, points.rows); });
    other_.finish();
  }
  unsigned rounds() const override { return 2; }

  void add(unsigned round, const OrderedPoints& points, Findings& findings) override {
    round == 0 ? own_.add(points.positions, points.rows) : compare(points, findings);
  }
  void end(unsigned round, Findings&) override {
    if (round == 0) own_.finish();
  }

 private:
  using Values = std::array<double, 6>;

  static PointCells cells(const InOrderSetup& setup) {
    return {PointCells::Space::all, setup.axis, setup.memory_bytes / 2, setup.make_scratch()};
  }

  void compare(const OrderedPoints& points, Findings& findings) {
    const std::vector<Section> own = sections(points, own_), other = sections(points, other_);
    std::vector<Values> values;
    for (std::size_t i = 0; i < own.size(); ++i) values.push_back(values_of(own[i], other[i]));
    add_findings(points.rows, std::as_bytes(std::span(values)), findings);
  }

  std::vector<Section> sections(const OrderedPoints& points, PointCells& cloud) const {
    std::vector<Section> all(points.rows.size());
    const auto place = [&](std::size_t i) { return points.positions[i]; };
    cloud.answer_all(all.size(), kPointsAtOnce, place, [&](std::size_t i, PointCells::View& view) {
      const Vec3 normal{points.values[3 * i], points.values[3 * i + 1], points.values[3 * i + 2]};
      if (!(length(normal) > 0) || !is_finite(normal)) return true;
      const Cylinder cylinder(place(i), normal, options_.cylinder, options_.depth);
      std::vector<double> along;
      const auto take = [&](const CellPoint& point) {
        if (const std::optional<double> a = cylinder.along(point.position)) along.push_back(*a);
      };
      if (!view.within(cylinder.box(), take)) return false;
      all[i] = section_of(along);
      return true;
    });
    return all;
  }

  /// Returns the values of a point in the order of InOrderContract::makes.
  Values values_of(const Section& own, const Section& other) const {
    const auto n1 = static_cast<double>(own.count), n2 = static_cast<double>(other.count);
    const double uncertainty = std::sqrt(own.spread * own.spread / n1 + other.spread * other.spread / n2);
    constexpr double k95Percent = 1.96;
    return {
        other.mean - own.mean, k95Percent * (uncertainty + options_.registration), own.spread, other.spread, n1, n2};
  }

  const M3c2Options options_;
  PointCells own_, other_;
};

const OptionTable<M3c2Options>& m3c2_options() {
  static const OptionTable<M3c2Options> table = {
      option("cloud", &M3c2Options::cloud,
             "the other cloud, measured later: a point file, a folder of them or a pattern",
             {.kind = OptionKind::file, .required = true, .positional = true, .sample = "after.las"}),
      // `is_radius` is true although the option is a diameter, because points within half of it count.
      option("cylinder", &M3c2Options::cylinder, "diameter of the cylinder along the normal (projection scale)",
             {.least = kAboveZero, .unit = "length", .required = true, .sample = 0.5, .is_radius = true}),
      option("depth", &M3c2Options::depth, "how far the cylinder reaches to each side of the point",
             {.least = kAboveZero, .unit = "length", .required = true, .sample = 2.0}),
      option("registration", &M3c2Options::registration, "error of the registration of the two clouds",
             {.unit = "length"})};
  return table;
}

/// Compares two clouds by M3C2: D. Lague, N. Brodu and J. Leroux, "Accurate 3D comparison of complex topography with
/// terrestrial laser scanner" (ISPRS Journal of Photogrammetry and Remote Sensing 82, 2013), Section 3, with every
/// point as a core point and the normals of an earlier stage or of the input.
class M3c2 final : public InOrderOperator {
 public:
  /// Throws UsageError for options outside of their ranges.
  explicit M3c2(M3c2Options options) : options_(std::move(options)) { m3c2_options().declare(*this, options_); }

  std::string name() const override { return "m3c2"; }
  InOrderContract in_order_contract() const override {
    return {.reads = {normal_attribute()},
            .makes = {nan_scalar("m3c2_distance", "length", "change to another cloud along the normal"),
                      nan_scalar("m3c2_lod", "length", "level of detection at 95 %"),
                      nan_scalar("m3c2_spread1", "length", "deviation along the normal, this cloud"),
                      nan_scalar("m3c2_spread2", "length", "deviation along the normal, other cloud"),
                      nan_scalar("m3c2_samples1", "1", "points in the cylinder, this cloud"),
                      nan_scalar("m3c2_samples2", "1", "points in the cylinder, other cloud")},
            .places = Places::of_operator,
            .arrival = "beside those of the other cloud"};
  }
  std::unique_ptr<InOrderWork> start(const InOrderSetup& setup) const override {
    return std::make_unique<M3c2Work>(options_, setup);
  }
  /// Returns the distance between the centre of a cylinder and its rim, the farthest part of it, with a margin for
  /// rounding.
  std::optional<Reach> reach() const override {
    return Reach{.distance = std::hypot(options_.cylinder / 2, options_.depth) * (1 + 1e-6)};
  }
  std::optional<Reach> other_reach() const override { return reach(); }
  std::string other_cloud() const override { return options_.cloud; }
  std::uint64_t least_bytes(const CloudEstimate&) const override { return 2 * PointCells::least_bytes(); }

 private:
  M3c2Options options_;
};

}  // namespace

OperatorDeclaration m3c2_declaration() {
  return {
      .name = "m3c2",
      .meaning = "measures the change to another cloud along the normals, with its level of detection (M3C2)",
      .options = m3c2_options().declarations(),
      .make = m3c2_options().maker<M3c2>(),
      .formula =
          "u_i = n_i / |n_i| in float64. Points of each cloud within R = cylinder / 2 of the line through p_i along "
          "u_i, |(p_j - p_i) × u_i|² <= R·R, and within depth of p_i along it have places a_j = (p_j - p_i) . u_i. "
          "With their mean m, their standard deviation s (of n - 1) and their number n: distance m_2 - m_1; level "
          "of detection 1.96 (sqrt(s_1² / n_1 + s_2² / n_2) + registration).",
      .source =
          "Lague, Brodu and Leroux, Accurate 3D comparison of complex topography with terrestrial laser scanner (ISPRS "
          "Journal of Photogrammetry and Remote Sensing 82, 2013), Section 3. Normals are those of the stages before, "
          "at their scale; every point that is left is a core point",
      .undefined =
          "Without a finite place all is NaN; without a normal all is NaN but the counts, which are 0. The distance is "
          "NaN where the cylinder holds no point of the other cloud, a spread where it holds fewer than two points of "
          "its cloud, and the level of detection where a spread is.",
      .cost =
          "a pass that puts the points in order along an axis and reads them twice; both clouds are kept in the "
          "temporary folder (32 bytes a point), and memory holds what is near the front; time grows with the points in "
          "a cylinder, and each thread needs 8 bytes for each of them, which --memory does not count",
      .attributes = {{.name = "m3c2_distance",
                      .meaning = "change along the normal, positive where the other cloud lies "
                                 "on the side of the normal; undefined: NaN"},
                     {.name = "m3c2_lod", .meaning = "smallest change that is significant at 95 %; undefined: NaN"},
                     {.name = "m3c2_spread1",
                      .meaning = "standard deviation along the normal in this cloud; undefined: NaN"},
                     {.name = "m3c2_spread2",
                      .meaning = "standard deviation along the normal in the other cloud; undefined: NaN"},
                     {.name = "m3c2_samples1", .meaning = "points of this cloud in the cylinder"},
                     {.name = "m3c2_samples2", .meaning = "points of the other cloud in the cylinder"}},
      .example = "knn(radius=1) | normals(orient=up) | m3c2(after.las, cylinder=0.5, depth=2)"};
}

ChainStage operators::m3c2(const M3c2Options& options) { return std::make_shared<M3c2>(options); }

}  // namespace pointsweep
