// SPDX-License-Identifier: MIT
/// The neighbourhood of one point with the weights of Equations 1 and 2.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "pointsweep/math/batch.h"
#include "pointsweep/math/exp.h"
#include "pointsweep/math/outer_product.h"
#include "pointsweep/math/symmetric3.h"
#include "pointsweep/points/neighborhoods.h"

namespace pointsweep {

/// θ(r) = exp(-r²/2σ²), σ² = π max_j |p_j - p_i|² / |N_i|. On a surface of even density σ is the point spacing, and
/// whatever |N_i| is, the weights add up to about 2π neighbours' worth.
///
/// Two factors are taken out of every sum, as `normals` does: offsets are scaled by the power of two that brings the
/// farthest neighbour to about 1, so that no extent of a cloud under- or overflows; and θ is divided by θ of the
/// nearest neighbour that is not on p_i, so that it does not vanish for every one of many thousand neighbours.
class WeightedNeighborhood {
 public:
  WeightedNeighborhood(const Neighborhoods& in, std::size_t i) : in_(in), i_(i), count_(in.count(i)) {
    const double largest = count_ == 0 ? 0 : magnitude(in.offset(i, count_ - 1));
    if (!(largest >= std::numeric_limits<double>::min() && largest < 0x1p1022)) {
      count_ = 0;
      return;
    }
    unscale_ = jacobi::power_of_two_below(largest);
    scale_ = jacobi::reciprocal_of_power(unscale_);
    std::size_t j = 0;
    while (j + 1 < count_ && in.offset(i, j) == Vec3{}) ++j;
    near2_ = length2(offset(j));
    falloff_ = double(count_) * (0.5 / std::numbers::pi) / length2(offset(count_ - 1));
  }

  /// |N_i|; 0 also where every neighbour lies on p_i, or one so far away that offsets overflow.
  std::size_t size() const { return count_; }
  /// scale() (p_j - p_i)
  Vec3 offset(std::size_t j) const { return scale_ * in_.offset(i_, j); }
  double scale() const { return scale_; }
  double unscale() const { return unscale_; }
  /// θ of every neighbour over that of the nearest one not on p_i, into theta[0] to theta[size() - 1].
  void thetas(std::vector<double>& theta) const {
    theta.resize(count_);
    for (std::size_t j = 0; j < count_; ++j) theta[j] = std::max(length2(offset(j)) - near2_, 0.0) * falloff_;
    batch_exp_negative(theta, theta);
  }
  /// |N_i| M_i of Equation 1, of scaled offsets; `theta` is room for the weights.
  Symmetric3 moments(std::vector<double>& theta) const {
    Symmetric3 m;
    thetas(theta);
    for (std::size_t j = 0; j < count_; ++j) add_outer_product(m, theta[j], offset(j));
    return m;
  }

 private:
  static double magnitude(Vec3 v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }
  static double length2(Vec3 v) { return distance2(v, {}); }

  const Neighborhoods& in_;
  std::size_t i_, count_;
  double scale_ = 1, unscale_ = 1, near2_ = 0, falloff_ = 0;
};

}  // namespace pointsweep
