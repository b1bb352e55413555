// SPDX-License-Identifier: MIT
/// From double to float without leaving the finite numbers.
#pragma once

#include <algorithm>
#include <limits>

namespace pointsweep {

/// v rounded to float; beyond the largest float, that float with the sign of v. v is not NaN.
inline float saturated_float(double v) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  return static_cast<float>(std::clamp(v, -kLargest, kLargest));
}

}  // namespace pointsweep
