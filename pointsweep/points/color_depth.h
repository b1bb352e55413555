// SPDX-License-Identifier: MIT
/// Colours of 8 bits, as PLY and PCD have them, and of 16 bits, as LAS has them: 255 and 65535 are both full brightness.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "pointsweep/points/schema.h"

namespace pointsweep {

/// `schema`, read with the brightness of `type`, u8 or u16: its red, green and blue of the other of these types are
/// scaled by 257 or by a 257th, as their values are stored in fields of `type`. Absent if they are not all three of the
/// other type. The type alone decides, never the values.
std::optional<Schema> with_colors_of(Type type, const Schema& schema);

/// Whether with_colors_of(Type::u8, ...) has scaled the field.
bool is_color_in_eight_bits(const Field& field);

/// Looks whether fields of 16 bits hold colours of 8 bits, as many LAS files have them against their specification.
class ColorsOfEightBits {
 public:
  /// `schema` is that of the records.
  explicit ColorsOfEightBits(const Schema& schema);
  void look_at(std::span<const std::byte> records);
  /// True if there is a colour and all are at most 255.
  bool found() const { return most_ > 0 && most_ <= 255; }

 private:
  std::array<std::uint32_t, 3> offsets_;
  std::size_t stride_;
  std::uint16_t most_ = 0;
};

}  // namespace pointsweep
