// SPDX-License-Identifier: MIT
#include "pointsweep/operators/surface/fair.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pointsweep/fail.h"
#include "pointsweep/math/batch.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"
#include "pointsweep/operators/kinds/box_reductions.h"
#include "pointsweep/operators/surface/splats.h"

namespace pointsweep {
namespace {

/// Returns 1 / width. Throws UsageError unless the width is positive, finite and large enough to have a finite
/// reciprocal.
double inverse_width(std::string_view option, double width) {
  const double inverse = 1 / width;
  if (!(width > 0 && std::isfinite(width) && std::isfinite(inverse)))
    fail_usage("fair: the width {} = {} is not a positive length; give one in the length unit of the cloud", option,
               width);
  return inverse;
}

/// Returns v / |v|, or (0, 0, 0) if v is 0 or not finite.
Vec3 unit_or_zero(Vec3 v) {
  const double size = length(v);
  return size > 0 && std::isfinite(size) ? (1 / size) * v : Vec3{};
}

/// Returns the area of a splat over π; 0 without a splat.
double area(float length, float ratio) {
  const double a = double(length) * double(length) * double(ratio);
  return a > 0 && std::isfinite(a) ? a : 0;
}

double square(double v) { return v * v; }

constexpr const char* kWidthUnit = "% of the diagonal";

const OptionTable<FairPercent>& fair_options() {
  static const OptionTable<FairPercent> table = {
      option("f", &FairPercent::f,
             "reach of the smoothing: standard deviation of the Gaussian weight of the distance to a neighbour, in % "
             "of the diagonal of the bounding box of the input",
             {.least = 1e-6, .most = 100, .unit = kWidthUnit}),
      option("g", &FairPercent::g,
             "height of the bumps that are removed: standard deviation of the Gaussian weight of the distance to the "
             "tangent plane of a neighbour, in % of the diagonal of the bounding box of the input",
             {.least = 1e-6, .most = 100, .unit = kWidthUnit})};
  return table;
}

/// Fair with both widths in % of the diagonal of the box around the finite points of the input that earlier stages have
/// kept, at their positions in the input. Moved positions do not count, even for a second `fair` or after `reneighbor`.
class FairInPercent final : public LocalOperator {
 public:
  /// Messages begin with `place`, e.g. "pipeline, column 20: fair".
  explicit FairInPercent(const FairPercent& percent, std::string place = "fair")
      : percent_(percent), place_(std::move(place)) {
    fair_options().declare(*this, percent);
  }
  std::string name() const override { return "fair"; }
  Contract contract() const override {
    Contract contract = Fair({.f = 1, .g = 1}).contract();
    contract.values = {std::make_shared<InputDiagonal>()};
    return contract;
  }
  void apply(const Neighborhoods&, Columns&) const override {}
  std::array<bool, 3> changes_system() const override { return {}; }
  /// Returns Fair with widths in length units. Throws UsageError if the diagonal is 0: there is no finite point, or all
  /// lie in one place.
  std::shared_ptr<const LocalOperator> with_values(std::span<const std::vector<double>> values) const override {
    const double diagonal = values[0][0];
    if (!(diagonal > 0))
      fail_usage("{}: all points lie in one place, so there is nothing to smooth; leave the stage out.", place_);
    const double percent = diagonal / 100;
    return std::make_shared<Fair>(FairOptions{.f = percent_.f * percent, .g = percent_.g * percent});
  }

 private:
  FairPercent percent_;
  std::string place_;
};

}  // namespace

OperatorDeclaration fair_declaration() {
  return {
      .name = "fair",
      .meaning = "edge-preserving smoothing: moves points towards the tangent planes of their neighbours (Equation 3)",
      .options = fair_options().declarations(),
      .make = fair_options().maker<FairInPercent>(),
      .formula =
          "p_i' = 1/w_i Σ_j Π_j(p_i) a_j f(|p_j - p_i|) g(|Π_j(p_i) - p_i|), j over N_i and i\n"
          "Π_j(p_i): projection of p_i onto the tangent plane of p_j; w_i: sum of the weights;\n"
          "a_j = π length² ratio of the splat of p_j; f and g: Gaussians exp(-r² / 2 width²).",
      .source =
          "Pajarola, Stream-Processing Points (IEEE Visualization 2005), Section 4.3.4, Equation 3; Π_j as in "
          "Jones, Durand and Desbrun, Non-iterative, feature-preserving mesh smoothing (2003)",
      .undefined = "A point stays where it is if no neighbour with a normal and a splat has a weight above 0.",
      .degenerate = "have no neighbour with a normal and a splat; they stay in place",
      .cost = "one reading of the input for the diagonal",
      .neighbor_ns = 20,
      .attributes = {{.name = "position",
                      .meaning = "moved position; undefined: the one before. float64 in the output too, unless "
                                 "`--positions float32` (`RunOptions::positions`) or a LAS grid rounds it"}},
      .example = "knn(k=64) | normals | splats | fair(f=0.3, g=0.3) | normals"};
}

ChainStage operators::fair(const FairOptions& options) { return std::make_shared<Fair>(options); }
ChainStage operators::fair_in_percent(const FairPercent& percent) { return std::make_shared<FairInPercent>(percent); }

/// Declares the widths in length units. Their names differ from the options of a stage in a pipeline, which are in %.
Fair::Fair(const FairOptions& options)
    : inverse_f_(inverse_width("f", options.f)), inverse_g_(inverse_width("g", options.g)) {
  declare_options({{"f_length", options.f}, {"g_length", options.g}});
}

Contract Fair::contract() const {
  return {.reads = {splat_length_attribute(), splat_ratio_attribute()},
          .reads_neighbors = {normal_attribute(), splat_length_attribute(), splat_ratio_attribute()},
          .makes = {position_attribute()},
          .default_k = 64};
}

/// A neighbour j that counts. The projection of p_i onto the tangent plane of j is p_i + off_plane · normal. `area`:
/// area of the splat of j over π.
struct Fair::Pull {
  Vec3 normal;
  double area, off_plane;
};

/// Collects the neighbours of point i that have a normal and a splat, and -ln(f g) of each. Sums of offsets from p_i
/// keep digits that sums of coordinates far from the origin would lose.
void Fair::collect(const Neighborhoods& in, std::size_t i, std::vector<Pull>& pulls,
                   std::vector<double>& exponents) const {
  pulls.clear(), exponents.clear();
  for (std::size_t j = 0; j < in.count(i); ++j) {
    const Vec3 normal = unit_or_zero(in.vector_of(0, in.neighbors(i)[j]));
    const double a = area(in.neighbor_value<float>(1, i, j), in.neighbor_value<float>(2, i, j));
    if (normal == Vec3{} || a == 0) continue;
    const Vec3 offset = in.offset(i, j);
    const double off_plane = dot(offset, normal);  // Π_j(p_i) = p_i + off_plane · normal
    const Vec3 reach = inverse_f_ * offset;
    pulls.push_back({normal, a, off_plane});
    exponents.push_back((dot(reach, reach) + square(inverse_g_ * off_plane)) / 2);
  }
}

/// Returns p_i' - p_i, or nullopt if no neighbour has a weight above 0. `own`: area over π of the splat of p_i, for
/// which f = g = 1. `falloffs`: f g of each neighbour.
std::optional<Vec3> Fair::shift(double own, const std::vector<Pull>& pulls, const std::vector<double>& falloffs) {
  double weights = own;
  Vec3 sum;
  bool found = false;
  for (std::size_t j = 0; j < pulls.size(); ++j) {
    const double weight = pulls[j].area * falloffs[j];
    if (!(weight > 0)) continue;
    sum = sum + (weight * pulls[j].off_plane) * pulls[j].normal;
    weights += weight;
    found = true;
  }
  if (!found) return std::nullopt;
  return (1 / weights) * sum;
}

void Fair::apply(const Neighborhoods& in, Columns& out) const {
  const std::span<std::array<double, 3>> moved = out.column<std::array<double, 3>>(0);
  std::vector<Pull> pulls;
  std::vector<double> falloffs;
  for (std::size_t i = 0; i < in.size(); ++i) {
    collect(in, i, pulls, falloffs);
    batch_exp_negative(falloffs, falloffs);
    const double own = area(in.value<float>(0, i), in.value<float>(1, i));
    Vec3 p = in.position(i);
    if (const std::optional<Vec3> s = shift(own, pulls, falloffs); s && is_finite(p + *s))
      p = p + *s;
    else
      out.mark_degenerate(i);
    moved[i] = {p.x, p.y, p.z};
  }
}

}  // namespace pointsweep
