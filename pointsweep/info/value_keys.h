// SPDX-License-Identifier: MIT
/// Values of a field as unsigned numbers of 64 bits, whose order is the order of the values.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pointsweep/info.h"
#include "pointsweep/math/exact_sum.h"
#include "pointsweep/points/decimals.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {

/// Maps values to numbers of the same order: a < b if and only if key(a) < key(b). Whole numbers keep all 64 bits.
/// Integers on a decimal grid are taken as decimal fractions (GridDecimals), and -0 as 0.
class ValueKeys {
 public:
  explicit ValueKeys(const Field& field);

  bool is_whole() const { return kind_ != Kind::real; }
  /// Returns whether the values are whole numbers of at most 32 bits.
  bool is_small() const { return is_whole() && size_of(field_.type) <= 4; }
  std::uint32_t components() const { return field_.count; }
  /// Writes the keys of all components of records `stride` bytes apart; keys of one record are adjacent.
  void find(std::span<const std::byte> records, std::size_t stride, std::vector<std::uint64_t>& keys) const;

  bool is_finite(std::uint64_t key) const { return is_whole() || (key > kNegativeInfinity && key < kInfinity); }
  /// Returns the value; a whole number of more than 53 bits may be rounded.
  double real(std::uint64_t key) const;
  /// Returns the value of a field of whole numbers.
  Int128 whole(std::uint64_t key) const;
  AttributeValue value(std::uint64_t key) const;

 private:
  enum class Kind : std::uint8_t { real, whole, natural };  ///< natural: unsigned integers of 64 bits
  static constexpr std::uint64_t kSign = std::uint64_t{1} << 63;
  static constexpr std::uint64_t key_of(double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value + 0.0);
    return (bits & kSign) != 0 ? ~bits : bits | kSign;
  }
  static constexpr std::uint64_t kInfinity = std::uint64_t{0x7ff} << 52 | kSign,
                                 kNegativeInfinity = ~(std::uint64_t{0xfff} << 52);

  Field field_;
  GridDecimals decimals_;
  Kind kind_ = Kind::real;
};

}  // namespace pointsweep
