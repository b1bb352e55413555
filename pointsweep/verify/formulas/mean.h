// SPDX-License-Identifier: MIT
/// Means of the points of a voxel.
#pragma once

#include <array>

#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep::formulas {

/// The mean of finite values, float64: their exact sum, rounded, over their number, not below the least nor above the
/// greatest.
class Mean {
 public:
  void add(double value);
  /// The mean and how far it may be off; NaN without values.
  Estimate real() const;
  /// Returns the mean as float32.
  Estimate single() const;
  /// Returns the mean as a whole number, halves to even; open where rounding decides.
  Estimate whole() const;

 private:
  Real sum_ = 0, magnitudes_ = 0, count_ = 0;
  bool are_whole_ = true;  ///< all values
  double least_ = static_cast<double>(kInfinity), most_ = -static_cast<double>(kInfinity);
};

/// Three numbers as one estimate.
Estimate mean_vector(const std::array<Mean, 3>& components);
/// The mean vector divided by its length, float32; 0 where that is 0 or not a number.
Estimate mean_direction(const std::array<Mean, 3>& components);

}  // namespace pointsweep::formulas
