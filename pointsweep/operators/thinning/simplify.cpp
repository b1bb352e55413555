// SPDX-License-Identifier: MIT
/// Keeping few points where the surface is flat.
#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/chain.h"
#include "pointsweep/fail.h"
#include "pointsweep/operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"
#include "pointsweep/operators/surface/curvature.h"

namespace pointsweep {
namespace {

/// The default of the largest radius, as a multiple of the error: the radius for a surface with a radius of curvature
/// of 512 errors.
constexpr double kMostOfErrors = 32;

const OptionTable<SimplifyOptions>& simplify_options() {
  static const OptionTable<SimplifyOptions> table = {
      option("error", &SimplifyOptions::error,
             "about the largest distance from a dropped point to the tangent plane of a kept one",
             {.least = kAboveZero, .unit = "length", .required = true, .positional = true, .sample = 0.01}),
      option("most", &SimplifyOptions::most,
             "maximum distance between kept points, on flat parts; without this option, 32 times error",
             {.least = kAboveZero, .unit = "length", .is_radius = true}),
      option("least", &SimplifyOptions::least,
             "minimum distance between kept points, where noise looks like curvature; at most `most`",
             {.unit = "length", .sample = 0.125, .is_radius = true})};
  return table;
}

double most_of(const SimplifyOptions& options) { return options.most.value_or(kMostOfErrors * options.error); }

/// Returns simplify_radius, one float64 per point, in length units: the distance up to which a kept point may represent
/// the point.
Attribute simplify_radius_attribute() {
  return scalar("simplify_radius", Type::f64, "length", "distance within which a kept point represents this one");
}

/// Makes simplify_radius = √(2 error / k1), limited to `least` and `most`: within this distance of a point, a surface
/// of curvature k1 deviates from the tangent plane by at most the error, to second order. A point whose k1 is not above
/// 0, or is NaN, gets `most`.
class SimplifyRadius final : public LocalOperator {
 public:
  explicit SimplifyRadius(const SimplifyOptions& options) : options_(options) {}
  std::string name() const override { return "simplify_radius"; }
  Contract contract() const override {
    return {.reads = {k1_attribute()}, .makes = {simplify_radius_attribute()}, .default_k = 0};
  }
  void apply(const Neighborhoods& in, Columns& out) const override {
    const std::span<double> radius = out.column<double>(0);
    const double most = most_of(options_);
    for (std::size_t i = 0; i < in.size(); ++i) {
      const double k1 = in.value<float>(0, i);
      const double r = k1 > 0 ? std::sqrt(2 * options_.error / k1) : most;
      radius[i] = std::clamp(r, options_.least, most);
    }
  }

 private:
  SimplifyOptions options_;
};

/// `simplify`: SimplifyRadius, then Poisson with simplify_radius as the radius of each point.
class Simplify final : public CompositeOperator {
 public:
  /// Throws UsageError for options out of their ranges, and if least is more than most; the message about least begins
  /// with `place`.
  explicit Simplify(const SimplifyOptions& options, const std::string& place = "simplify") : options_(options) {
    simplify_options().declare(*this, options);
    if (options.least > most_of(options))
      fail_usage(
          "{}: least is {}, but most, the largest distance between kept points, is {}; give least of at most that.",
          place, options.least, most_of(options));
  }
  std::string name() const override { return "simplify"; }
  Contract contract() const override { return SimplifyRadius(options_).contract(); }
  std::vector<ChainStage> parts() const override {
    const PoissonOptions disks{.radius = most_of(options_), .radius_from = simplify_radius_attribute().name};
    return {std::make_shared<SimplifyRadius>(options_), operators::poisson(disks)};
  }

 private:
  SimplifyOptions options_;
};

}  // namespace

OperatorDeclaration simplify_declaration() {
  return {.name = "simplify",
          .meaning = "keeps few points on flat parts and many on curved ones: poisson with a radius from the curvature",
          .options = simplify_options().declarations(),
          .make = simplify_options().maker<Simplify>(),
          .formula =
              "r_i = √(2 error / k1_i), at least `least`, at most `most`; then poisson(most, radius_from=r).\n"
              "A surface of curvature k1 leaves its tangent plane by k1 r² / 2 at the distance r.",
          .undefined = "A point without curvature (k1 = 0) gets the largest radius.",
          .cost = "that of poisson with the radius `most`",
          .attributes = {{.name = "simplify_radius",
                          .meaning = "distance within which a kept point represents this one; `least` to `most`"}},
          .example = "knn(k=24) | normals | curvature | simplify(error=0.01)"};
}

ChainStage operators::simplify(const SimplifyOptions& options) { return std::make_shared<Simplify>(options); }

}  // namespace pointsweep
