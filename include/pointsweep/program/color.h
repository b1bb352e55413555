// SPDX-License-Identifier: MIT
/// The type of colours.
#pragma once

#include <cstdint>

namespace pointsweep {

/// A colour of 8 bits for each channel.
struct Rgb {
  std::uint8_t red = 0, green = 0, blue = 0;
  friend bool operator==(const Rgb&, const Rgb&) = default;
};

}  // namespace pointsweep
