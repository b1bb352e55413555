// SPDX-License-Identifier: MIT
/// Elementary functions and powers of two, made of plain IEEE operations, so that they have the same bits on every
/// machine. Results of the C library may differ in the last bit between processors.
///
/// The method of exp(-x): let n = round(x / ln 2) and y = n ln 2 - x, so that |y| <= ln 2 / 2. Then exp(-x) = 2^-n
/// exp(y), and exp(y) = 1 + (y + y² q(y)). The polynomial q of degree 9 is interpolated at Chebyshev nodes on |y| <=
/// 0.3467 (error below 2^-57) and summed by Estrin's scheme. The error of exp(-x) is at most 1 ulp. In single precision
/// q has degree 4 (error below 2^-26). exp_lanes-inl.h does the operations of exp(-x) and of the logarithm in the same
/// order, one argument per lane.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <iterator>
#include <limits>

namespace pointsweep {

/// The constants of exp_negative() in one precision.
template <class Real>
struct ExpConstants;

template <>
struct ExpConstants<double> {
  using Bits = std::uint64_t;
  static constexpr double kLargest = 708;  ///< largest x whose result is not 0; exp(-708) is still a normal number
  static constexpr double kLog2E = 0x1.71547652b82fep+0;
  static constexpr double kLn2High = 0x1.62e42feep-1;  ///< n * kLn2High is exact
  static constexpr double kLn2Low = 0x1.a39ef35793c76p-33;
  static constexpr double kRound = 0x1.8p52;  ///< adding kRound rounds to an integer, which then fills the low bits
  static constexpr int kMantissaBits = 52;
  static constexpr Bits kExponentOfOne = 1023;
  static constexpr double kQ[10] = {
      0x1.0000000000001p-1, 0x1.5555555555556p-3,  0x1.5555555553d56p-5,  0x1.11111111109afp-7,  0x1.6c16c17890eb4p-10,
      0x1.a01a01a7c73cp-13, 0x1.a019b8f9792eep-16, 0x1.71de0da24602dp-19, 0x1.28919ccaf9211p-22, 0x1.af38c67fbb53ep-26};
};

template <>
struct ExpConstants<float> {
  using Bits = std::uint32_t;
  static constexpr float kLargest = 87;
  static constexpr float kLog2E = 0x1.715476p+0f;
  static constexpr float kLn2High = 0x1.62e4p-1f;
  static constexpr float kLn2Low = 0x1.7f7d1cp-20f;
  static constexpr float kRound = 0x1.8p23f;
  static constexpr int kMantissaBits = 23;
  static constexpr Bits kExponentOfOne = 127;
  static constexpr float kQ[5] = {0x1p-1f, 0x1.5554dcp-3f, 0x1.55551ap-5f, 0x1.120b9p-7f, 0x1.6d112cp-10f};
};

/// Returns exp(-x) for x >= 0 (infinity included): in double to 1 ulp, 0 for x > 708; in single precision to 2 ulps, 0
/// for x > 87.
template <std::floating_point Real>
Real exp_negative(Real x) {
  using C = ExpConstants<Real>;
  using Bits = typename C::Bits;
  const auto line = [](int i, Real y) { return C::kQ[i] + C::kQ[i + 1] * y; };
  const Real bounded = std::min(x, C::kLargest);
  const Real shifted = bounded * C::kLog2E + C::kRound;
  const Real n = shifted - C::kRound;
  const Real y = n * C::kLn2Low - (bounded - n * C::kLn2High);
  const Real y2 = y * y, y4 = y2 * y2;
  Real high = C::kQ[4];
  if constexpr (std::size(C::kQ) == 10) high = (line(4, y) + line(6, y) * y2) + line(8, y) * y4;
  const Real q = (line(0, y) + line(2, y) * y2) + high * y4;
  const Real mantissa = 1 + (y + y2 * q);
  const Real power =
      std::bit_cast<Real>((C::kExponentOfOne << C::kMantissaBits) - (std::bit_cast<Bits>(shifted) << C::kMantissaBits));
  return x > C::kLargest ? 0 : mantissa * power;
}

/// Returns ln(x) for normal x > 0, with a relative error below 1e-13: x = m 2^e with m in (1/sqrt(2), sqrt(2)], and
/// ln(m) = 2 artanh((m-1)/(m+1)).
inline double natural_logarithm(double x) {
  auto bits = std::bit_cast<std::uint64_t>(x);
  auto exponent = static_cast<int>(bits >> 52) - 1023;
  double m = std::bit_cast<double>((bits & 0xfffffffffffff) | 0x3ff0000000000000);
  if (m > 1.4142135623730951) {
    m *= 0.5;
    ++exponent;
  }
  const double z = (m - 1) / (m + 1), z2 = z * z;
  double sum = 1.0 / 19;
  for (const double odd : {17, 15, 13, 11, 9, 7, 5, 3, 1}) sum = sum * z2 + 1.0 / odd;
  return 2 * z * sum + 0.69314718055994530942 * exponent;
}

/// Returns a power of two for use as a scale, since multiplication by a power of two rounds nothing: 2^e for x in [2^e,
/// 2^(e+1)), 0 below the normal numbers, infinity if x is not finite.
inline double power_of_two_below(double x) {
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(x) & std::uint64_t{0x7ff} << 52);
}
/// Returns 1 / power for a power of two under 2^1023; returns 2^1023 for 0.
inline double reciprocal_of_power(double power) {
  return std::bit_cast<double>((std::uint64_t{2046} << 52) - std::bit_cast<std::uint64_t>(power));
}

/// Returns exp(x), to 8 ulps: infinite above 709.78, 0 below -745.2, NaN for NaN.
inline double exponential(double x) {
  if (std::isnan(x)) return x;
  const double size = std::fabs(x), most = ExpConstants<double>::kLargest;
  // Beyond `most`, exp(x) may be finite although exp_negative() has no result, so exp(x) is computed as the square of
  // exp(x / 2).
  const double root = exp_negative(size > most ? size / 2 : size);
  const double power = x > 0 ? 1 / root : root;
  return size > most ? power * power : power;
}

/// Returns ln(x), to 8 ulps: NaN below 0, -infinity for 0, NaN for NaN.
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

/// Returns the angle of (x, y) from the x axis, in radians, in [-pi, pi], to 8 ulps; signs of zeros and infinities as
/// in C. NaN if an argument is NaN.
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
