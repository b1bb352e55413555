// SPDX-License-Identifier: MIT
#include "pointsweep/points/color_depth.h"

#include <algorithm>
#include <array>

namespace pointsweep {
namespace {

constexpr std::array kColors{"red", "green", "blue"};
constexpr double kSixteenOfEight = 257;  ///< 65535 / 255

bool is_plain_color(const Schema& schema, const char* name, Type type) {
  const auto at = schema.find(name);
  return at && schema.fields[*at].is_plain() && schema.fields[*at].type == type && schema.fields[*at].count == 1;
}

bool has_colors_of(const Schema& schema, Type type) {
  return std::ranges::all_of(kColors, [&](const char* name) { return is_plain_color(schema, name, type); });
}

}  // namespace

bool has_wide_colors(const Schema& schema) { return has_colors_of(schema, Type::u16); }

std::optional<Schema> with_wide_colors(const Schema& schema) {
  if (!has_colors_of(schema, Type::u8)) return std::nullopt;
  Schema scaled = schema;
  for (const char* name : kColors) scaled.fields[*schema.find(name)].scale = kSixteenOfEight;
  return scaled;
}

}  // namespace pointsweep
