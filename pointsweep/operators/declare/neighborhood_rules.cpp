// SPDX-License-Identifier: MIT
/// The rules of neighbourhoods: limits that are attributes of the point, and the size of the least eigenentropy.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/fail.h"
#include "pointsweep/math/batch.h"
#include "pointsweep/math/exp.h"
#include "pointsweep/math/symmetric3.h"
#include "pointsweep/neighborhood.h"
#include "pointsweep/operators.h"

namespace pointsweep {
namespace {

Attribute named(const std::string& name) { return scalar(name, Type::f64, "", "size of the neighbourhood"); }

/// Returns how many of `count` neighbours the limit `value` of k allows.
std::size_t at_most(double value, std::size_t count) {
  if (!(value >= 1)) return 0;
  return value < static_cast<double>(count) ? static_cast<std::size_t>(value) : count;
}

/// Returns how many of the first `count` neighbours lie within `radius`. Neighbours come nearest first.
std::size_t within(double radius, const Neighborhoods& in, std::size_t i, std::size_t count) {
  if (!(radius >= 0)) return 0;
  const double radius2 = radius * radius;
  std::size_t low = 0, high = count;  // before `low` within the radius, from `high` on outside of it
  while (low < high) {
    const std::size_t middle = low + (high - low) / 2;
    in.distance2(i, middle) <= radius2 ? low = middle + 1 : high = middle;
  }
  return low;
}

/// Keeps the neighbours that both limits allow. NaN, a negative value or a k below 1 allows none: operators count a
/// point without neighbours as degenerate. A value above the limits of the search allows all neighbours found. A radius
/// of 0 keeps the neighbours that coincide with the point. A neighbour is within the radius if ((dx² + dy²) + dz²) <=
/// radius · radius in double, as for the radius of `knn`. So `neighbor_radius`, the rounded root of a squared distance,
/// may be too small by one unit in the last place to include the farthest neighbour, from which it comes.
class LimitsFromAttributes final : public NeighborhoodRule {
 public:
  /// Throws UsageError if `limits` names no attribute.
  explicit LimitsFromAttributes(AttributeLimits limits) : limits_(std::move(limits)) {
    if (limits_.k.empty() && limits_.radius.empty())
      fail_usage("Neighbourhoods limited by attributes need the name of one, for k or for the radius.");
  }
  std::string meaning() const override {
    std::string text;
    if (!limits_.k.empty()) text += "as many as '" + limits_.k + "' says";
    if (!limits_.radius.empty()) text += (text.empty() ? "" : ", ") + ("those within '" + limits_.radius + "'");
    return text;
  }
  std::vector<Attribute> reads() const override {
    std::vector<Attribute> attributes;
    for (const std::string& name : {limits_.k, limits_.radius})
      if (!name.empty()) attributes.push_back(named(name));
    return attributes;
  }
  Options options() const override {
    Options options;
    if (!limits_.k.empty()) options.push_back({"k_from", limits_.k});
    if (!limits_.radius.empty()) options.push_back({"radius_from", limits_.radius});
    return options;
  }
  void choose(const Neighborhoods& in, std::span<std::uint32_t> counts) const override {
    const std::size_t radius = limits_.k.empty() ? 0 : 1;  // index of the radius in reads()
    for (std::size_t i = 0; i < in.size(); ++i) {
      std::size_t count = in.count(i);
      if (!limits_.k.empty()) count = at_most(in.value<double>(0, i), count);
      if (!limits_.radius.empty()) count = within(in.value<double>(radius, i), in, i, count);
      counts[i] = static_cast<std::uint32_t>(count);
    }
  }

 private:
  AttributeLimits limits_;
};

constexpr double kSmallest = std::numeric_limits<double>::min();

/// Returns -e ln e; 0 for an e below the smallest normal number. Rounding may make the eigenvalue of a plane or a line
/// slightly negative.
double entropy_of(double e) { return e >= kSmallest ? -(e * natural_logarithm(e)) : 0; }

/// Returns the eigenentropy; infinite if the points have no extent.
double eigenentropy(const Eigen3& eigen) {
  const double sum = (eigen.value[0] + eigen.value[1]) + eigen.value[2];
  if (!(sum >= kSmallest)) return std::numeric_limits<double>::infinity();
  return (entropy_of(eigen.value[0] / sum) + entropy_of(eigen.value[1] / sum)) + entropy_of(eigen.value[2] / sum);
}

/// Returns the power of two that scales the farthest neighbour to about 1, so that no extent of a cloud under- or
/// overflows. Returns 0 if there is no such power.
double scale_of(Vec3 farthest) {
  const double largest = std::max({std::abs(farthest.x), std::abs(farthest.y), std::abs(farthest.z)});
  if (!(largest >= kSmallest && largest < 0x1p1022)) return 0;
  return reciprocal_of_power(power_of_two_below(largest));
}

/// Computes, for each k from `least` to in.count(i), the covariance of p_i and its k nearest neighbours about their
/// mean, times the number of points and `scale` squared; the factor does not change ratios of eigenvalues.
void covariances(const Neighborhoods& in, std::size_t i, std::size_t least, double scale,
                 std::vector<Symmetric3>& out) {
  Symmetric3 squares;
  Vec3 sum;
  out.clear();
  for (std::size_t j = 0; j < in.count(i); ++j) {
    const Vec3 o = scale * in.offset(i, j);
    add_outer_product(squares, 1, o);
    sum = sum + o;
    if (j + 1 < least) continue;
    const double points = static_cast<double>(j + 2);  // includes p_i, whose offset is 0
    Symmetric3 m = squares;
    add_outer_product(m, -1 / points, sum);
    out.push_back(m);
  }
}

/// For every k from `least` up to the number of neighbours found, take the covariance of the positions of p_i and its k
/// nearest neighbours about their mean. Let e1, e2, e3 be its eigenvalues, each divided by the sum of all three. The
/// point keeps the k at which the eigenentropy
///   E = -(e1 ln e1 + e2 ln e2 + e3 ln e3)
/// is least. If several k have the least E, the point keeps the smallest.
///
/// Source: M. Weinmann, B. Jutzi, C. Mallet, "Semantic 3D scene interpretation: a framework combining optimal
/// neighborhood size selection with relevant features", ISPRS Annals II-3 (2014), and Weinmann et al., "Semantic point
/// cloud interpretation based on optimal neighborhoods, relevant features and efficient classifiers", ISPRS Journal 105
/// (2015), which uses E instead of the entropy of the three dimensionality features of Demantké et al., "Dimensionality
/// based scale selection in 3D lidar point clouds" (2011). The papers let k run from 10 to 100 in steps of 1, as here.
///
/// Cases that the papers leave open: e ln e is 0 at e = 0 (points on a plane or a line); a k whose neighbours all
/// coincide with p_i has no E and is skipped; a point with fewer than `least` neighbours, or without any E, keeps all
/// its neighbours. The covariance comes from running sums of offsets from p_i, and the logarithm is made of plain IEEE
/// operations, so that near-ties have the same result on every machine.
///
/// Cost: about 0.1 µs for each k tried, in addition to the search for the largest k.
class LeastEigenentropy final : public NeighborhoodRule {
 public:
  /// Throws UsageError unless `least` is at least 3, the number of neighbours that spans a volume.
  explicit LeastEigenentropy(std::size_t least) : least_(least) {
    if (least < 3)
      fail_usage("The least k to choose from is {}, but fewer than 3 neighbours never span a volume.", least);
  }
  std::string meaning() const override {
    return fmt::format("the first {} or more with the least eigenentropy", least_);
  }
  std::vector<Attribute> reads() const override { return {}; }
  Options options() const override { return {{"adaptive", "eigenentropy"}, {"k_min", std::uint64_t{least_}}}; }
  void choose(const Neighborhoods& in, std::span<std::uint32_t> counts) const override {
    std::vector<Symmetric3> matrices;
    std::vector<Eigen3> eigen;
    for (std::size_t i = 0; i < in.size(); ++i) {
      const std::size_t count = in.count(i);
      counts[i] = static_cast<std::uint32_t>(count);
      const double scale = count > least_ ? scale_of(in.offset(i, count - 1)) : 0;
      if (scale == 0) continue;
      covariances(in, i, least_, scale, matrices);
      eigen.resize(matrices.size());
      batch_eigen_symmetric3(matrices, eigen);
      double best = std::numeric_limits<double>::infinity();
      for (std::size_t m = 0; m < eigen.size(); ++m) {
        const double entropy = eigenentropy(eigen[m]);
        if (!(entropy < best)) continue;
        best = entropy;
        counts[i] = static_cast<std::uint32_t>(least_ + m);
      }
    }
  }

 private:
  std::size_t least_;
};

}  // namespace

SharedRule operators::limits_from_attributes(const AttributeLimits& limits) {
  return std::make_shared<LimitsFromAttributes>(limits);
}

SharedRule operators::least_eigenentropy(std::size_t least) { return std::make_shared<LeastEigenentropy>(least); }

}  // namespace pointsweep
