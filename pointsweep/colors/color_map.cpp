// SPDX-License-Identifier: MIT
#include "pointsweep/colors/color_map.h"

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

/// Coefficients of Turbo's polynomials for red, green and blue, the constant first.
constexpr double kTurbo[3][6] = {{0.13572138, 4.61539260, -42.66032258, 132.13108234, -152.94239396, 59.28637943},
                                 {0.09140261, 2.19418839, 4.84296658, -14.18503333, 4.27729857, 2.82956604},
                                 {0.10667330, 12.64194608, -60.58204836, 110.36276771, -89.90310912, 27.34824973}};

std::uint8_t byte_of_share(double share) { return static_cast<std::uint8_t>(255 * std::clamp(share, 0.0, 1.0) + 0.5); }

constexpr std::array<Rgb, 23> kColors = {{{150, 150, 150},    // never classified
                                          {190, 190, 190},    // unclassified
                                          {168, 112, 56},     // ground
                                          {170, 215, 110},    // low vegetation
                                          {85, 180, 70},      // medium vegetation
                                          {20, 125, 50},      // high vegetation
                                          {225, 75, 60},      // building
                                          {220, 40, 220},     // low point (noise)
                                          {120, 120, 120},    // reserved
                                          {60, 130, 230},     // water
                                          {120, 70, 160},     // rail
                                          {75, 80, 95},       // road surface
                                          {120, 120, 120},    // reserved
                                          {250, 225, 90},     // wire, guard
                                          {245, 190, 30},     // wire, conductor
                                          {240, 135, 20},     // transmission tower
                                          {200, 160, 20},     // wire connector
                                          {0, 170, 185},      // bridge deck
                                          {255, 110, 255},    // high noise
                                          {255, 160, 140},    // overhead structure
                                          {215, 175, 130},    // ignored ground
                                          {205, 235, 255},    // snow
                                          {235, 205, 235}}};  // temporal exclusion
/// Colours of reserved and user-definable classes from 23 on; adjacent classes have different colours.
constexpr std::array<Rgb, 6> kOthers = {
    {{66, 105, 208}, {239, 177, 24}, {108, 197, 176}, {164, 99, 242}, {156, 107, 78}, {255, 138, 183}}};

}  // namespace

Rgb no_value_color() { return kNoValue; }

Rgb turbo(double value) {
  if (!(value == value)) return kNoValue;
  const double x = std::clamp(value, 0.0, 1.0);
  const auto channel = [x](const double(&a)[6]) {
    return byte_of_share(((((a[5] * x + a[4]) * x + a[3]) * x + a[2]) * x + a[1]) * x + a[0]);
  };
  return {channel(kTurbo[0]), channel(kTurbo[1]), channel(kTurbo[2])};
}

Rgb gray(double value) {
  if (!(value == value)) return kNoValue;
  const std::uint8_t level = byte_of_share(value);
  return {level, level, level};
}

Rgb viridis(double value) {
  if (!(value == value)) return kNoValue;
  const double place = std::clamp(value, 0.0, 1.0) * static_cast<double>(kViridis.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(place), kViridis.size() - 2);
  return mixed(kViridis[i], kViridis[i + 1], place - static_cast<double>(i));
}

Rgb mixed(Rgb a, Rgb b, double t) {
  const auto between = [t](std::uint8_t low, std::uint8_t high) {
    return static_cast<std::uint8_t>(low + (static_cast<double>(high) - low) * t + 0.5);
  };
  return {between(a.red, b.red), between(a.green, b.green), between(a.blue, b.blue)};
}

Rgb shaded(Rgb color, double light) {
  const double l = std::clamp(light, 0.0, 1.0);
  const auto part = [l](std::uint8_t c) { return static_cast<std::uint8_t>(c * l + 0.5); };
  return {part(color.red), part(color.green), part(color.blue)};
}

Rgb color_of_las_class(std::uint8_t code) {
  return code < kColors.size() ? kColors[code] : kOthers[code % kOthers.size()];
}

}  // namespace pointsweep
