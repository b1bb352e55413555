// SPDX-License-Identifier: MIT
/// The colours that the operator color() makes of values, by tables and polynomials written for the check.
#pragma once

#include <array>

namespace pointsweep::formulas {

enum class ColorScale : unsigned char { viridis, turbo, gray, classes };

/// Returns red, green and blue of 8 bits, each 128 for NaN and for an infinite value without a place on the scale.
/// `lo`, `hi`: ends of the scale; unused for `classes`.
std::array<int, 3> color_of(double value, ColorScale scale, double lo, double hi);

}  // namespace pointsweep::formulas
