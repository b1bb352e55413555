// SPDX-License-Identifier: MIT
/// Neighbourhoods of the size at which they resemble a line, a plane or a volume most, and a mixture least.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pointsweep/neighborhood.h"

namespace pointsweep {

/// For every k from `least` up to the number of neighbours found, let e1, e2, e3 be the eigenvalues of the covariance
/// of the positions of p_i and its k nearest neighbours about their mean, divided by their sum. The point keeps the k
/// at which the eigenentropy
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
  explicit LeastEigenentropy(std::size_t least = 10);
  std::string meaning() const override;
  std::vector<Attribute> reads() const override { return {}; }
  Options options() const override { return {{"adaptive", "eigenentropy"}, {"k_min", std::uint64_t{least_}}}; }
  void choose(const Neighborhoods& in, std::span<std::uint32_t> counts) const override;

 private:
  std::size_t least_;
};

}  // namespace pointsweep
