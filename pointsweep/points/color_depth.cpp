// SPDX-License-Identifier: MIT
#include "pointsweep/points/color_depth.h"

#include <algorithm>
#include <cstring>

namespace pointsweep {
namespace {

constexpr std::array kColors{"red", "green", "blue"};
constexpr double kSixteenOfEight = 257, kEightOfSixteen = 1.0 / 257;

/// The three fields of `type`; absent if there are not three.
std::optional<std::array<std::size_t, 3>> colors_of(Type type, const Schema& schema) {
  std::array<std::size_t, 3> found{};
  for (std::size_t c = 0; c < found.size(); ++c) {
    const auto at = schema.find(kColors[c]);
    if (!at) return std::nullopt;
    const Field& field = schema.fields[*at];
    const bool plain = field.scale == 1 && field.bias == 0 && (field.bit_width == 0 || type == Type::u8);
    if (!plain || unpacked_type(field) != type || field.count != 1) return std::nullopt;
    found[c] = *at;
  }
  return found;
}

}  // namespace

std::optional<Schema> with_colors_of(Type type, const Schema& schema) {
  const auto colors = colors_of(type == Type::u8 ? Type::u16 : Type::u8, schema);
  if (!colors) return std::nullopt;
  Schema scaled = schema;
  for (const std::size_t c : *colors) scaled.fields[c].scale = type == Type::u8 ? kEightOfSixteen : kSixteenOfEight;
  return scaled;
}

bool is_color_in_eight_bits(const Field& field) { return field.type == Type::u16 && field.scale == kEightOfSixteen; }

ColorsOfEightBits::ColorsOfEightBits(const Schema& schema) : offsets_{}, stride_(schema.stride) {
  for (std::size_t c = 0; c < offsets_.size(); ++c) offsets_[c] = schema.fields[schema.find(kColors[c]).value()].offset;
}

void ColorsOfEightBits::look_at(std::span<const std::byte> records) {
  if (most_ > 255) return;
  for (std::size_t at = 0; at < records.size(); at += stride_)
    for (const std::uint32_t offset : offsets_) {
      std::uint16_t value = 0;
      std::memcpy(&value, records.data() + at + offset, sizeof value);
      most_ = std::max(most_, value);
    }
}

}  // namespace pointsweep
