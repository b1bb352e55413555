// SPDX-License-Identifier: MIT
/// The local outlier factor: how much sparser the surroundings of a point are than the surroundings of its neighbours
/// (M. M. Breunig, H.-P. Kriegel, R. T. Ng, J. Sander, "LOF: identifying density-based local outliers", 2000).
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/chain.h"
#include "pointsweep/operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/kinds/results.h"

namespace pointsweep {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

double finite_or_none(double v) { return std::isfinite(v) ? v : kNone; }

/// Fills the only column with value(i), or NaN for points without neighbours, and marks the points whose value is NaN
/// as degenerate.
template <class Value>
void fill_column(const Neighborhoods& in, Columns& out, const Value& value) {
  const std::span<double> column = out.column<double>(0);
  for (std::size_t i = 0; i < in.size(); ++i) {
    const double v = in.count(i) == 0 ? kNone : value(i);
    column[i] = std::isnan(v) ? kNone : v;
    if (std::isnan(v)) out.mark_degenerate(i);
  }
}

/// Returns the larger number; NaN if one of them is NaN.
double larger(double a, double b) { return std::isnan(a) || std::isnan(b) ? kNone : a > b ? a : b; }

double quotient(double r, double by) { return std::isinf(r) && std::isinf(by) ? 1 : r / by; }

/// The attributes that the operators below make, one float64 of each per point: NaN for points without neighbours, for
/// points with a neighbour that has no finite place, and where an attribute that the formula reads is NaN.
Attribute k_distance_attribute() { return nan_scalar("k_distance", "length", "distance to the farthest neighbour"); }

Attribute reachability_density_attribute() {
  return nan_scalar("reachability_density", "1/length", "inverse of the mean reachability distance");
}

Attribute lof_attribute() { return nan_scalar("lof", "1", "local outlier factor"); }

/// Makes k_distance: the distance to the farthest neighbour.
class KDistance final : public LocalOperator {
 public:
  std::string name() const override { return "k_distance"; }
  Contract contract() const override { return {{}, {}, {k_distance_attribute()}}; }
  void apply(const Neighborhoods& in, Columns& out) const override {
    fill_column(in, out, [&](std::size_t i) { return finite_or_none(std::sqrt(in.farthest_distance2(i))); });
  }
};

/// Makes reachability_density: |N_i| / Σ_j max(k_distance_j, |p_j - p_i|), in the order of the neighbours; infinite if
/// all terms of the sum are 0.
class ReachabilityDensity final : public LocalOperator {
 public:
  std::string name() const override { return "reachability_density"; }
  Contract contract() const override { return {{}, {k_distance_attribute()}, {reachability_density_attribute()}}; }
  void apply(const Neighborhoods& in, Columns& out) const override {
    fill_column(in, out, [&](std::size_t i) {
      double sum = 0;
      for (std::size_t j = 0; j < in.count(i); ++j)
        sum += larger(in.neighbor_value<double>(0, i, j), std::sqrt(in.distance2(i, j)));
      return static_cast<double>(in.count(i)) / finite_or_none(sum);
    });
  }
};

/// Makes lof: 1/|N_i| Σ_j r_j / r_i with reachability densities r, in the order of the neighbours. The quotient of two
/// infinite densities is 1.
class DensityRatio final : public LocalOperator {
 public:
  std::string name() const override { return "density_ratio"; }
  Contract contract() const override {
    return {{reachability_density_attribute()}, {reachability_density_attribute()}, {lof_attribute()}};
  }
  void apply(const Neighborhoods& in, Columns& out) const override {
    fill_column(in, out, [&](std::size_t i) {
      const double own = in.value<double>(0, i);
      double sum = 0;
      for (std::size_t j = 0; j < in.count(i); ++j) sum += quotient(in.neighbor_value<double>(0, i, j), own);
      return sum / static_cast<double>(in.count(i));
    });
  }
};

/// `lof`: KDistance, ReachabilityDensity and DensityRatio, in order.
class LocalOutlierFactor final : public CompositeOperator {
 public:
  std::string name() const override { return "lof"; }
  Contract contract() const override {
    return {.makes = {k_distance_attribute(), reachability_density_attribute(), lof_attribute()}, .default_k = 32};
  }
  std::vector<ChainStage> parts() const override {
    return {std::make_shared<KDistance>(), std::make_shared<ReachabilityDensity>(), std::make_shared<DensityRatio>()};
  }
};

}  // namespace

OperatorDeclaration lof_declaration() {
  return {.name = "lof",
          .meaning =
              "local outlier factor: how many times sparser a point lies than its neighbours do; about 1 inside a "
              "cloud",
          .make = [](const OptionValues&, const Facts&) { return std::make_shared<LocalOutlierFactor>(); },
          .formula =
              "k_distance_i = max_j |p_j - p_i| over N_i, which does not hold p_i\n"
              "reachability_density: r_i = |N_i| / Σ_j max(k_distance_j, |p_j - p_i|)\n"
              "lof_i = 1/|N_i| Σ_j r_j / r_i\n"
              "Exactly k neighbours count, as in scikit-learn and PDAL (filters.lof, minpts is k); in the "
              "publication more, where several are as far as the k-th. scikit-learn adds 1e-10 to the mean "
              "reachability; here r is infinite where that is 0, and the quotient of two of them is 1.",
          .source =
              "Breunig, Kriegel, Ng, Sander, LOF: identifying density-based local outliers (SIGMOD 2000), "
              "Definitions 3 to 7",
          .undefined =
              "NaN without neighbours, or if the point, a neighbour or a neighbour of one has no finite place or "
              "no neighbours.",
          .degenerate = "have no neighbours with a place; their lof is NaN",
          .cost = "three steps: points stay in memory until the neighbours of their neighbours are known",
          .attributes = {{.name = "k_distance", .meaning = "distance to the farthest neighbour; undefined: NaN"},
                         {.name = "reachability_density",
                          .meaning = "inverse mean reachability of the neighbours; undefined: NaN"},
                         {.name = "lof", .meaning = "local outlier factor, about 1 inside a cloud; undefined: NaN"}},
          .example = "knn(k=20) | lof | where(lof < 1.5)"};
}

ChainStage operators::lof() { return std::make_shared<LocalOutlierFactor>(); }

}  // namespace pointsweep
