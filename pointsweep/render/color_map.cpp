// SPDX-License-Identifier: MIT
#include "pointsweep/render/color_map.h"

#include <algorithm>
#include <array>

namespace pointsweep {
namespace {

constexpr std::array<Rgb, 10> kViridis = {{{68, 1, 84},
                                           {72, 40, 120},
                                           {62, 74, 137},
                                           {49, 104, 142},
                                           {38, 130, 142},
                                           {31, 158, 137},
                                           {53, 183, 121},
                                           {109, 205, 89},
                                           {180, 222, 44},
                                           {253, 231, 37}}};
constexpr Rgb kNoValue{128, 128, 128};

std::uint8_t between(std::uint8_t a, std::uint8_t b, double t) {
  return static_cast<std::uint8_t>(a + (static_cast<double>(b) - a) * t + 0.5);
}

}  // namespace

Rgb viridis(double value) {
  if (!(value == value)) return kNoValue;
  const double place = std::clamp(value, 0.0, 1.0) * static_cast<double>(kViridis.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(place), kViridis.size() - 2);
  const double t = place - static_cast<double>(i);
  const Rgb a = kViridis[i], b = kViridis[i + 1];
  return {between(a.red, b.red, t), between(a.green, b.green, t), between(a.blue, b.blue, t)};
}

Rgb shaded(Rgb color, double light) {
  const double l = std::clamp(light, 0.0, 1.0);
  const auto part = [l](std::uint8_t c) { return static_cast<std::uint8_t>(c * l + 0.5); };
  return {part(color.red), part(color.green), part(color.blue)};
}

}  // namespace pointsweep
