// SPDX-License-Identifier: MIT
/// exp(-x) made of plain IEEE operations, so that it has the same bits on every machine; std::exp does not promise
/// that.
///
/// With n = round(x / ln 2) and y = n ln 2 - x, |y| <= ln 2 / 2: exp(-x) = 2^-n exp(y). exp(y) = 1 + (y + y² q(y)),
/// with q of degree 9 interpolated at Chebyshev nodes on |y| <= 0.3467 (error of the polynomial below 2^-57) and summed
/// by Estrin's scheme. Error at most 1 ulp. In single precision q is of degree 4 (error below 2^-26). exp_lanes-inl.h
/// does the same operations in the same order, one argument per lane.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

namespace pointsweep {

namespace exp_constants {
inline constexpr double kLargest = 708;  ///< beyond it the result is 0; exp(-708) is still a normal number
inline constexpr double kLog2E = 0x1.71547652b82fep+0;
inline constexpr double kLn2High = 0x1.62e42feep-1;  ///< n * kLn2High is exact
inline constexpr double kLn2Low = 0x1.a39ef35793c76p-33;
inline constexpr double kRound = 0x1.8p52;  ///< adding it rounds to an integer and leaves it in the low bits
inline constexpr double kQ[10] = {
    0x1.0000000000001p-1, 0x1.5555555555556p-3,  0x1.5555555553d56p-5,  0x1.11111111109afp-7,  0x1.6c16c17890eb4p-10,
    0x1.a01a01a7c73cp-13, 0x1.a019b8f9792eep-16, 0x1.71de0da24602dp-19, 0x1.28919ccaf9211p-22, 0x1.af38c67fbb53ep-26};
}  // namespace exp_constants

/// The same in single precision.
namespace exp_constants_f32 {
inline constexpr float kLargest = 87;
inline constexpr float kLog2E = 0x1.715476p+0f;
inline constexpr float kLn2High = 0x1.62e4p-1f;
inline constexpr float kLn2Low = 0x1.7f7d1cp-20f;
inline constexpr float kRound = 0x1.8p23f;
inline constexpr float kQ[5] = {0x1p-1f, 0x1.5554dcp-3f, 0x1.55551ap-5f, 0x1.120b9p-7f, 0x1.6d112cp-10f};
}  // namespace exp_constants_f32

/// exp(-x) for x >= 0 (infinity included), 0 for x > 708.
inline double exp_negative(double x) {
  using namespace exp_constants;
  const double bounded = std::min(x, kLargest);
  const double shifted = bounded * kLog2E + kRound;
  const double n = shifted - kRound;
  const double y = n * kLn2Low - (bounded - n * kLn2High);
  const double y2 = y * y, y4 = y2 * y2;
  const double low = (kQ[0] + kQ[1] * y) + (kQ[2] + kQ[3] * y) * y2;
  const double high = (kQ[4] + kQ[5] * y) + (kQ[6] + kQ[7] * y) * y2;
  const double q = low + (high + (kQ[8] + kQ[9] * y) * y4) * y4;
  const double mantissa = 1 + (y + y2 * q);
  const double power =
      std::bit_cast<double>((std::uint64_t{1023} << 52) - (std::bit_cast<std::uint64_t>(shifted) << 52));
  return x > kLargest ? 0 : mantissa * power;
}

/// exp(-x) to 2 ulps for x >= 0 (infinity included), 0 for x > 87.
inline float exp_negative_f32(float x) {
  using namespace exp_constants_f32;
  const float bounded = std::min(x, kLargest);
  const float shifted = bounded * kLog2E + kRound;
  const float n = shifted - kRound;
  const float y = n * kLn2Low - (bounded - n * kLn2High);
  const float y2 = y * y;
  const float q = ((kQ[0] + kQ[1] * y) + (kQ[2] + kQ[3] * y) * y2) + kQ[4] * (y2 * y2);
  const float mantissa = 1 + (y + y2 * q);
  const float power = std::bit_cast<float>((std::uint32_t{127} << 23) - (std::bit_cast<std::uint32_t>(shifted) << 23));
  return x > kLargest ? 0 : mantissa * power;
}

}  // namespace pointsweep
