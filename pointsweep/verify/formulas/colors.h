// SPDX-License-Identifier: MIT
/// The colours that the operator color() makes of values, by tables written for the check.
#pragma once

#include <array>

namespace pointsweep::formulas {

enum class ColorScale : unsigned char { viridis, turbo, gray, classes };

/// Returns red, green and blue of 8 bits. `lo`, `hi`: ends of the scale; unused for `classes`.
std::array<int, 3> color_of(double value, ColorScale scale, double lo, double hi);

}  // namespace pointsweep::formulas
