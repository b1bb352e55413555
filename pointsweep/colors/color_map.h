// SPDX-License-Identifier: MIT
/// Colours for numbers and for the classes of airborne scans.
#pragma once

#include <cstdint>

#include "pointsweep/program/color.h"

namespace pointsweep {

/// Returns a colour of Viridis (van der Walt and Smith 2015, CC0), interpolated between ten of its colours. Equal steps
/// of the value are perceived as equal, also in grey and by colour-blind people. 0 is dark violet and 1 is yellow.
/// Values outside of [0, 1] get the colours of the ends, NaN gets no_value_color().
Rgb viridis(double value);
/// Returns a colour of Turbo (Mikhailov 2019, by his polynomials), a smooth rainbow from dark blue over green to dark
/// red. Values outside of [0, 1] and NaN get colours as in viridis().
Rgb turbo(double value);
/// Returns a grey from black (0) to white (1). Values outside of [0, 1] and NaN get colours as in viridis().
Rgb gray(double value);
/// Returns the grey that stands for NaN.
Rgb no_value_color();

/// Returns the colour that is the share `t`, 0 to 1, of the way from `a` to `b`.
Rgb mixed(Rgb a, Rgb b, double t);

/// Returns `color` times `light`, 0 to 1.
Rgb shaded(Rgb color, double light);

/// Returns the colour of a class of LAS 1.4. ASPRS names the classes and leaves their colours to programs; the colours
/// here follow common viewers: ground brown, vegetation green, buildings red, water blue, noise magenta.
Rgb color_of_las_class(std::uint8_t code);

}  // namespace pointsweep
