// SPDX-License-Identifier: MIT
/// The logarithm from plain IEEE operations: the logarithm of the C library may differ in the last bit from one
/// processor to the next, and results and generated clouds are the same bytes everywhere.
#pragma once

#include <bit>
#include <cstdint>
#include <initializer_list>

namespace pointsweep {

/// ln(x) for normal x > 0, off by less than 1e-13 relative: x = m 2^e with m in [1/sqrt(2), sqrt(2)), and
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

}  // namespace pointsweep
