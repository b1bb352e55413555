// SPDX-License-Identifier: MIT
#include "pointsweep/operators/thinning/simplify.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "pointsweep/fail.h"
#include "pointsweep/operators/declare/declaration.h"
#include "pointsweep/operators/surface/curvature.h"
#include "pointsweep/operators/thinning/poisson.h"

namespace pointsweep {
namespace {

/// The largest radius, in errors, unless it is given: the radius for a surface with a radius of curvature of 512
/// errors.
constexpr double kMostOfErrors = 32;

Options all_options(const SimplifyOptions& options) {
  return {{"error", options.error}, {"most", options.most}, {"least", options.least}};
}

MadeStage make_simplify(const OptionValues& options, const Facts&) {
  const double error = options.number("error");
  const double most = options.given("most") ? options.number("most") : kMostOfErrors * error;
  return std::make_shared<Simplify>(SimplifyOptions{.error = error, .most = most, .least = options.number("least")});
}

}  // namespace

OperatorDeclaration simplify_declaration() {
  return {.name = "simplify",
          .meaning = "keeps few points on flat parts and many on curved ones: poisson with a radius from the curvature",
          .options = {{.name = "error",
                       .kind = OptionKind::number,
                       .meaning = "about the largest distance from a dropped point to the tangent plane of a kept one",
                       .least = kAboveZero,
                       .unit = "length",
                       .required = true,
                       .positional = true,
                       .sample = 0.01},
                      {.name = "most",
                       .kind = OptionKind::number,
                       .meaning = "maximum distance between kept points, on flat parts; without this option, 32 times "
                                  "error",
                       .least = kAboveZero,
                       .unit = "length",
                       .is_radius = true},
                      {.name = "least",
                       .kind = OptionKind::number,
                       .preset = 0.0,
                       .meaning = "minimum distance between kept points, where noise looks like curvature; at most "
                                  "`most`",
                       .unit = "length",
                       .sample = 0.125,
                       .is_radius = true}},
          .make = make_simplify,
          .formula =
              "r_i = √(2 error / k1_i), at least `least`, at most `most`; then poisson(most, radius_from=r).\n"
              "A surface of curvature k1 leaves its tangent plane by k1 r² / 2 at the distance r.",
          .undefined = "A point without curvature (k1 = 0) gets the largest radius.",
          .cost = "that of poisson with the radius `most`",
          .attributes = {{.name = "simplify_radius",
                          .meaning = "distance within which a kept point represents this one; `least` to `most`"}},
          .example = "knn(k=24) | normals | curvature | simplify(error=0.01)"};
}

Attribute simplify_radius_attribute() {
  return scalar("simplify_radius", Type::f64, "length", "distance within which a kept point represents this one");
}

Contract SimplifyRadius::contract() const {
  return {.reads = {k1_attribute()}, .makes = {simplify_radius_attribute()}, .default_k = 0};
}

void SimplifyRadius::apply(const Neighborhoods& in, Columns& out) const {
  const std::span<double> radius = out.column<double>(0);
  for (std::size_t i = 0; i < in.size(); ++i) {
    const double k1 = in.value<float>(0, i);
    const double r = k1 > 0 ? std::sqrt(2 * options_.error / k1) : options_.most;
    radius[i] = std::clamp(r, options_.least, options_.most);
  }
}

Options SimplifyRadius::own_options() const { return all_options(options_); }

Simplify::Simplify(SimplifyOptions options) : options_(options) {
  const bool positive = options.error > 0 && std::isfinite(options.error) && options.most > 0;
  if (!positive || !(options.least >= 0 && options.least <= options.most))
    fail_usage(
        "simplify: error {}, least {} and most {} have to be lengths: error and most positive, least at most the "
        "latter.",
        options.error, options.least, options.most);
}

Contract Simplify::contract() const {
  return {.reads = {k1_attribute()}, .makes = {simplify_radius_attribute()}, .default_k = 0};
}

Options Simplify::own_options() const { return all_options(options_); }

std::vector<ChainStage> Simplify::parts() const {
  const PoissonOptions disks{.radius = options_.most, .radius_from = simplify_radius_attribute().name};
  return {std::make_shared<SimplifyRadius>(options_), std::make_shared<Poisson>(disks)};
}

}  // namespace pointsweep
