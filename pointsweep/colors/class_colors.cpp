// SPDX-License-Identifier: MIT
#include "pointsweep/colors/class_colors.h"

#include <array>

namespace pointsweep {
namespace {

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
/// For reserved and user-definable classes: neighbours differ.
constexpr std::array<Rgb, 6> kOthers = {
    {{66, 105, 208}, {239, 177, 24}, {108, 197, 176}, {164, 99, 242}, {156, 107, 78}, {255, 138, 183}}};

}  // namespace

Rgb color_of_las_class(std::uint8_t code) {
  return code < kColors.size() ? kColors[code] : kOthers[code % kOthers.size()];
}

}  // namespace pointsweep
