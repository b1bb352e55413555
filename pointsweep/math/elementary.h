// SPDX-License-Identifier: MIT
/// Elementary functions of float64, made of plain IEEE operations, as in exp.h: equal bits on every machine. Errors are
/// at most 8 ulps.
#pragma once

#include <cmath>
#include <limits>

#include "pointsweep/math/exp.h"

namespace pointsweep {

/// Returns exp(x): infinite above 709.78, 0 below -745.2, NaN for NaN.
inline double exponential(double x) {
  if (std::isnan(x)) return x;
  const double size = std::fabs(x), most = ExpConstants<double>::kLargest;
  // Beyond `most`, exp(x) may be finite although exp_negative() has no result, so it is computed as the square of exp(x
  // / 2).
  const double root = exp_negative(size > most ? size / 2 : size);
  const double power = x > 0 ? 1 / root : root;
  return size > most ? power * power : power;
}

/// Returns ln(x): NaN below 0, -infinity for 0, NaN for NaN.
inline double logarithm(double x) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  if (std::isnan(x) || x < 0) return std::numeric_limits<double>::quiet_NaN();
  if (x == 0) return -kInfinite;
  if (x == kInfinite) return x;
  // The factor 2^54 turns subnormal numbers into normal numbers.
  const bool is_normal = x >= std::numeric_limits<double>::min();
  return is_normal ? natural_logarithm(x) : natural_logarithm(x * 0x1p54) - 54 * 0.69314718055994530942;
}

/// Returns arctan(t) for 0 <= t <= 1. With the multiple c of 1/4 nearest to t and u = (t - c) / (1 + c t), |u| <= 1/8:
/// arctan(t) = arctan(c) + arctan(u). arctan(u) comes from its power series up to u^17.
inline double arctangent_of_unit(double t) {
  constexpr double kOfQuarters[5] = {0, 0x1.f5b75f92c80ddp-3, 0x1.dac670561bb4fp-2, 0x1.4978fa3269ee1p-1,
                                     0x1.921fb54442d18p-1};
  const auto quarter = static_cast<int>(4 * t + 0.5);
  const double c = 0.25 * quarter, u = (t - c) / (1 + c * t), u2 = u * u;
  double sum = 1.0 / 17;
  for (const double odd : {15, 13, 11, 9, 7, 5, 3}) sum = 1 / odd - u2 * sum;
  return kOfQuarters[quarter] + (u - u * u2 * sum);
}

/// Returns the angle of (x, y) from the x axis, in radians, in [-pi, pi]; signs of zeros and infinities as in C. NaN if
/// an argument is NaN.
inline double arctangent2(double y, double x) {
  if (std::isnan(x) || std::isnan(y)) return std::numeric_limits<double>::quiet_NaN();
  constexpr double kPi = 0x1.921fb54442d18p+1;
  const double across = std::fabs(y), along = std::fabs(x);
  const double least = across < along ? across : along, most = across < along ? along : across;
  const double first = arctangent_of_unit(most == 0 ? 0 : least == most ? 1 : least / most);
  const double acute = across > along ? kPi / 2 - first : first;
  return std::copysign(std::signbit(x) ? kPi - acute : acute, y);
}

}  // namespace pointsweep
