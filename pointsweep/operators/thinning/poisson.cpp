// SPDX-License-Identifier: MIT
/// Keeping points that are farther from each other than a radius.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/fail.h"
#include "pointsweep/in_order_operator.h"
#include "pointsweep/math/mix.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"
#include "pointsweep/operators/expressions/named_values.h"
#include "pointsweep/operators/thinning/undecided_points.h"

namespace pointsweep {
namespace {

/// Returns the radius of a point: the value of its attribute, at most the limit; NaN and negative values count as 0.
double own_radius(double value, double limit) { return value > 0 ? std::min(value, limit) : 0; }

/// Largest number of points that come before UndecidedPoints::decide() is called again.
constexpr std::uint64_t kHeldAtMost = 4096;

class PoissonFront final : public InOrderWork {
 public:
  /// `values`: number of values that are read of each point; value number `component` is the radius. If `values` is 0,
  /// all points have the radius `radius`.
  PoissonFront(const InOrderSetup& setup, double radius, std::size_t values, std::size_t component)
      : points_(setup.axis, radius, setup.memory_bytes / UndecidedPoints::kPointBytes),
        may_lack_(setup.may_lack),
        radius_(radius),
        values_(values),
        component_(component) {}

  void add(unsigned, const OrderedPoints& points, Findings& findings) override {
    for (std::size_t i = 0; i < points.rows.size(); ++i) {
      const double r = values_ == 0 ? radius_ : own_radius(points.values[i * values_ + component_], radius_);
      const Vec3 p = points.positions[i];
      points_.hold({p, coordinate_hash(p, kPoissonSeed), points.rows[i], r * r}, may_lack_ && may_lack_(p, r));
      if (++since_decision_ == kHeldAtMost) points_.decide(findings), since_decision_ = 0;
    }
    points_.decide(findings);
  }
  void end(unsigned, Findings& findings) override { points_.finish(findings); }

 private:
  UndecidedPoints points_;
  std::function<bool(Vec3, double)> may_lack_;
  double radius_;
  std::size_t values_, component_;
  std::size_t since_decision_ = 0;
};

const OptionTable<PoissonOptions>& poisson_options() {
  static const OptionTable<PoissonOptions> table = {
      option("radius", &PoissonOptions::radius,
             "minimum distance between kept points; with radius_from, its upper limit",
             {.least = kAboveZero,
              .unit = "length",
              .required = true,
              .positional = true,
              .sample = 0.5,
              .is_radius = true}),
      option("radius_from", &PoissonOptions::radius_from,
             "attribute of the input, or made before, that holds the minimum distance from each point to the kept ones",
             {.kind = OptionKind::attribute, .is_radius = true})};
  return table;
}

/// Takes the points in ascending order of the hash of their coordinates, equal hashes by x, y, z, then row. A point is
/// kept unless a kept point lies within the point's own radius. So every dropped point has a kept point within its
/// radius, and the later of two kept points is farther from the other than its own radius. Points without a finite
/// place are all kept.
class Poisson final : public InOrderOperator {
 public:
  /// Throws UsageError for options out of their ranges, and if the square of the radius cannot be represented.
  explicit Poisson(PoissonOptions options) : options_(std::move(options)) {
    poisson_options().declare(*this, options_);
    const double r = options_.radius;
    if (!std::isnormal(r * r))
      fail_usage("poisson: double precision cannot hold the square of the radius {}: scale the coordinates.", r);
  }
  std::string name() const override { return "poisson"; }
  InOrderContract in_order_contract() const override {
    return {.reads = reads_, .drops_rows = true, .arrival = "each held until all points within the radius have come"};
  }
  std::unique_ptr<InOrderWork> start(const InOrderSetup& setup) const override {
    const std::size_t values = reads_.empty() ? 0 : reads_.front().fields.size();
    return std::make_unique<PoissonFront>(setup, options_.radius, values, component_);
  }
  /// Returns a guess of eight radii: chains of points that depend on each other are seldom longer.
  std::optional<Reach> reach() const override { return Reach{.distance = 8 * options_.radius, .is_guess = true}; }
  /// Returns the memory for the points that are undecided at a time (undecided_points.h): all points less than a radius
  /// behind the newest point along the axis, and the points that wait for one of them. Counts the points of a slice of
  /// two radii.
  std::uint64_t least_bytes(const CloudEstimate& cloud) const override {
    const std::uint64_t near = cloud.slice_points(2 * options_.radius) + kHeldAtMost;
    return UndecidedPoints::kPointBytes * std::min(cloud.points, near);
  }
  /// Throws UsageError if radius_from does not name a single value of each point.
  std::shared_ptr<const InOrderOperator> bound(const Schema& input, std::span<const Attribute> made) const override {
    if (options_.radius_from.empty()) return nullptr;
    auto bound = std::make_shared<Poisson>(*this);
    const MeantValue meant = meant_value(options_.radius_from, input, made);
    if (meant.made != nullptr) {
      bound->reads_ = {*meant.made};
      bound->component_ = meant.component;
      return bound;
    }
    if (meant.field == nullptr || meant.field->count != 1)
      fail_usage(
          "poisson: radius_from={}: neither the input nor an earlier stage has a single value of this name for "
          "each point.",
          options_.radius_from);
    bound->reads_ = {scalar(meant.field->name, Type::f64, "length", "radius of the point")};
    return bound;
  }

 private:
  PoissonOptions options_;
  std::vector<Attribute> reads_;  ///< the attribute that radius_from names; empty without one
  std::size_t component_ = 0;     ///< component of the attribute
};

}  // namespace

OperatorDeclaration poisson_declaration() {
  return {.name = "poisson",
          .meaning = "keeps points that are farther than a radius from each other and leave no gap wider than it",
          .options = poisson_options().declarations(),
          .make = poisson_options().maker<Poisson>(),
          .formula =
              "In ascending order of h_i (ties by x, y, z, then row) a point is kept unless a kept point j has "
              "|p_i - p_j|² <= r_i², ((dx² + dy²) + dz²) in float64.\n"
              "So of two points at exactly the radius the first in that order stays, and the other is left out.\n"
              "h: the hash of decimate with the seed 0x706f6973736f6e.\n"
              "r_i = radius, or min(radius_from, radius); 0 where radius_from is NaN or negative.",
          .source =
              "The greedy maximal independent set, the same in any order of evaluation: Blelloch, Fineman and "
              "Shun (SPAA 2012).",
          .undefined = "Points without a finite place all stay.",
          .cost =
              "a pass that puts the points in order, without a search; memory holds the points of a slice about "
              "two radii thick",
          .example = "knn(k=12) | poisson(0.2) | normals"};
}

ChainStage operators::poisson(const PoissonOptions& options) { return std::make_shared<Poisson>(options); }

}  // namespace pointsweep
