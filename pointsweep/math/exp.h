// SPDX-License-Identifier: MIT
/// exp(-x), the logarithm and powers of two, made of plain IEEE operations, so that they have the same bits on every
/// machine. Results of the C library may differ in the last bit between processors.
///
/// The method of exp(-x): with n = round(x / ln 2) and y = n ln 2 - x, |y| <= ln 2 / 2: exp(-x) = 2^-n exp(y). exp(y) =
/// 1 + (y + y² q(y)), with q of degree 9 interpolated at Chebyshev nodes on |y| <= 0.3467 (error of the polynomial
/// below 2^-57) and summed by Estrin's scheme. Error at most 1 ulp. In single precision q is of degree 4 (error below
/// 2^-26). exp_lanes-inl.h does the operations of exp(-x) and of the logarithm in the same order, one argument per
/// lane.
#pragma once

#include <algorithm>
#include <bit>
#include <concepts>
#include <cstdint>
#include <iterator>

namespace pointsweep {

template <class Real>
struct ExpConstants;

template <>
struct ExpConstants<double> {
  using Bits = std::uint64_t;
  static constexpr double kLargest = 708;  ///< largest x whose result is not 0; exp(-708) is still a normal number
  static constexpr double kLog2E = 0x1.71547652b82fep+0;
  static constexpr double kLn2High = 0x1.62e42feep-1;  ///< n * kLn2High is exact
  static constexpr double kLn2Low = 0x1.a39ef35793c76p-33;
  static constexpr double kRound = 0x1.8p52;  ///< its addition rounds to an integer, which is then in the low bits
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

/// Returns ln(x) for normal x > 0, with a relative error below 1e-13: x = m 2^e with m in [1/sqrt(2), sqrt(2)), and
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

}  // namespace pointsweep
