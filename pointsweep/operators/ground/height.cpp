// SPDX-License-Identifier: MIT
/// Height above the ground: above the nearest points of the ground in the plane.
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "pointsweep/in_order_operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"
#include "pointsweep/operators/expressions/named_values.h"
#include "pointsweep/operators/ground/ground_work.h"
#include "pointsweep/operators/kinds/results.h"
#include "pointsweep/operators/nearest/point_cells.h"

namespace pointsweep {
namespace {

constexpr double kGroundClass = 2;

double height_above(double z, const std::vector<CellNeighbor>& ground) {
  if (ground.empty()) return std::numeric_limits<double>::quiet_NaN();
  if (ground.front().distance2 == 0) return z - ground.front().position.z;
  double sum = 0, weights = 0;
  for (const CellNeighbor& g : ground) {
    const double weight = 1 / g.distance2;
    sum += weight * g.position.z;
    weights += weight;
  }
  return z - sum / weights;
}

/// First round: stores the ground points in cells. Second round: finds the nearest ground points of each point, and
/// makes its height.
class HeightWork final : public InOrderWork {
 public:
  HeightWork(std::size_t k, const InOrderSetup& setup)
      : k_(k), ground_(PointCells::Space::plane, setup.axis, setup.memory_bytes, setup.make_scratch()) {}
  unsigned rounds() const override { return 2; }

  void add(unsigned round, const OrderedPoints& points, Findings& findings) override {
    if (points.rows.empty()) return;
    round == 0 ? add_ground(points) : measure(points, findings);
  }
  void end(unsigned round, Findings&) override {
    if (round == 0) ground_.finish();
  }
  std::string warning() const override {
    return has_ground_ || !has_points_
               ? ""
               : "no point has class 2 (ground), so that all heights are NaN; find the ground first.";
  }

 private:
  void add_ground(const OrderedPoints& points) {
    for (std::size_t i = 0; i < points.rows.size(); ++i)
      if (points.values[i] == kGroundClass) ground_.add(points.positions[i], points.rows[i]);
    has_points_ = true;
    has_ground_ = has_ground_ || std::ranges::find(points.values, double{kGroundClass}) != points.values.end();
  }

  void measure(const OrderedPoints& points, Findings& findings) {
    std::vector<double> heights(points.rows.size());
    ground_.nearest_of_all(points.positions, {.k = k_}, [&](std::size_t i, const std::vector<CellNeighbor>& ground) {
      heights[i] = height_above(points.positions[i].z, ground);
    });
    add_findings(points.rows, std::as_bytes(std::span(heights)), findings);
  }

  std::size_t k_;
  bool has_points_ = false, has_ground_ = false;
  PointCells ground_;
};

const OptionTable<HeightOptions>& height_options() {
  static const OptionTable<HeightOptions> table = {
      only_choice<HeightOptions>("from", "ground", "measure height from the points of class 2"),
      option("k", &HeightOptions::k, "number of nearest ground points over which the height of the ground is averaged",
             {.least = 1, .most = 1024})};
  return table;
}

/// Makes height: z - Σ w_j z_j / Σ w_j over the k points of class 2 that are nearest in x and y, w_j = 1 / d_j² with
/// the distance d_j in x and y, summed nearest first; if d_1 = 0, height is z - z_1; without ground points it is NaN.
/// Equal distances are ordered by x, y, z, row. All ground points of the cloud are searched, however far away.
class Height final : public InOrderOperator {
 public:
  /// Throws UsageError for options outside of their ranges.
  explicit Height(const HeightOptions& options) : options_(options) { height_options().declare(*this, options); }
  std::string name() const override { return "height"; }
  InOrderContract in_order_contract() const override {
    return {.reads = {class_},
            .makes = {nan_scalar("height", "length", "z above the nearest points of the ground; NaN without any")},
            .places = Places::in_plane,
            .arrival = "beside those of the ground"};
  }
  std::shared_ptr<const InOrderOperator> bound(const Schema& input, std::span<const Attribute> made) const override {
    const std::optional<Attribute> found = single_value("classification", input, made);
    if (!found) return nullptr;
    auto bound = std::make_shared<Height>(*this);
    bound->class_ = *found;
    return bound;
  }
  Vec3 place_of(Vec3 position) const override { return {position.x, position.y, 0}; }
  std::unique_ptr<InOrderWork> start(const InOrderSetup& setup) const override {
    return std::make_unique<HeightWork>(static_cast<std::size_t>(options_.k), setup);
  }
  std::optional<Reach> reach() const override {
    return Reach{std::numeric_limits<double>::infinity(), static_cast<std::size_t>(options_.k)};
  }
  /// Returns a function that chooses the ground points, since a point may have its nearest ground points in another
  /// part.
  ChoosePoints for_other_parts() const override {
    return [](const OrderedPoints& points) {
      std::vector<std::uint32_t> ground;
      for (std::uint32_t i = 0; i < points.rows.size(); ++i)
        if (points.values[i] == kGroundClass) ground.push_back(i);
      return ground;
    };
  }
  std::uint64_t least_bytes(const CloudEstimate&) const override { return PointCells::least_bytes(); }

 private:
  HeightOptions options_;
  Attribute class_ = classification_attribute();
};

}  // namespace

OperatorDeclaration height_declaration() {
  return {.name = "height",
          .meaning = "measures the height above the nearest points of the ground, in the plane of x and y",
          .options = height_options().declarations(),
          .make = height_options().maker<Height>(),
          .formula =
              "h = z - Σ_j w_j z_j / Σ_j w_j, w_j = 1 / d_j², over the k points of class 2 that are nearest "
              "in x and y: d_j² = dx² + dy² in float64, equal ones by x, y, z, row; summed nearest first.\n"
              "Where d_1 = 0: h = z - z_1.",
          .source =
              "Inverse distance weighting: Shepard, A two-dimensional interpolation function for "
              "irregularly-spaced data (ACM National Conference 1968)",
          .undefined = "NaN where the cloud has no point of class 2, and for points without a finite place.",
          .cost =
              "a pass that puts the points in order along x or y and reads them twice; points of the ground are "
              "kept in the temporary folder in cells, and memory holds those near the front",
          .attributes = {{.name = "height", .meaning = "z above the nearest points of the ground; undefined: NaN"}},
          .example = "knn(k=8) | ground | height(k=3) | where(height < 2)"};
}

ChainStage operators::height(const HeightOptions& options) { return std::make_shared<Height>(options); }

}  // namespace pointsweep
