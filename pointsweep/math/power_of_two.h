// SPDX-License-Identifier: MIT
/// Powers of two as scales: multiplying by one rounds nothing.
#pragma once

#include <bit>
#include <cstdint>

namespace pointsweep {

/// 2^e for x in [2^e, 2^(e+1)), 0 below the normal numbers; infinity for what is not finite.
inline double power_of_two_below(double x) {
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(x) & std::uint64_t{0x7ff} << 52);
}
/// 1 / power, for a power of two under 2^1023, or 0 (then 2^1023).
inline double reciprocal_of_power(double power) {
  return std::bit_cast<double>((std::uint64_t{2046} << 52) - std::bit_cast<std::uint64_t>(power));
}

}  // namespace pointsweep
