// SPDX-License-Identifier: MIT
/// Integers of 192 bits: sums of squares of positions that do not depend on the order of their terms.
#pragma once

#include <array>
#include <cstdint>

namespace pointsweep {

__extension__ typedef __int128 Int128;
__extension__ typedef unsigned __int128 UInt128;

/// Modulo 2^192, in two's complement: a result in [-2^191, 2^191) is exact, whatever the sums on the way were.
class Int192 {
 public:
  Int192() = default;
  Int192(Int128 value) : Int192(static_cast<UInt128>(value), value < 0 ? ~std::uint64_t{0} : 0) {}
  static Int192 product(Int128 a, Int128 b) {
    const auto a0 = static_cast<std::uint64_t>(a), b0 = static_cast<std::uint64_t>(b);
    const auto a1 = static_cast<std::int64_t>(a >> 64), b1 = static_cast<std::int64_t>(b >> 64);
    const auto times = [](std::int64_t high, std::uint64_t low) { return static_cast<UInt128>(Int128{high}) * low; };
    const UInt128 lowest = static_cast<UInt128>(a0) * b0, middle = times(a1, b0) + times(b1, a0);
    const auto highest = static_cast<std::uint64_t>(a1) * static_cast<std::uint64_t>(b1);
    const UInt128 low = lowest + (middle << 64);
    return {low, highest + static_cast<std::uint64_t>(middle >> 64) + (low < lowest ? 1 : 0)};
  }

  Int192& operator+=(const Int192& other) {
    const UInt128 more = other.low(), sum = low() + more;
    return *this = {sum, limbs_[2] + other.limbs_[2] + (sum < more ? 1 : 0)};
  }
  Int192 operator-() const {
    const UInt128 negative = -low();
    return {negative, ~limbs_[2] + (negative == 0 ? 1 : 0)};
  }
  friend Int192 operator-(Int192 a, const Int192& b) { return a += -b; }
  /// Converts with a relative error below 2^-51.
  explicit operator double() const {
    if (limbs_[2] >> 63 != 0) return -static_cast<double>(-*this);
    return static_cast<double>(limbs_[2]) * 0x1p128 + static_cast<double>(low());
  }

 private:
  Int192(UInt128 low, std::uint64_t high)
      : limbs_{static_cast<std::uint64_t>(low), static_cast<std::uint64_t>(low >> 64), high} {}
  UInt128 low() const { return static_cast<UInt128>(limbs_[1]) << 64 | limbs_[0]; }

  std::array<std::uint64_t, 3> limbs_{};  ///< the lowest first
};

}  // namespace pointsweep
