// SPDX-License-Identifier: MIT
/// Numbers as colours.
#pragma once

#include "pointsweep/colors/rgb.h"

namespace pointsweep {

/// Viridis (van der Walt and Smith 2015, CC0): equal steps of the value look equally far apart, also in grey and to the
/// colour-blind. 0 is dark violet, 1 yellow; outside of it the ends, NaN is grey.
Rgb viridis(double value);
/// Turbo (Mikhailov 2019, by his polynomials): a rainbow without its bands; from dark blue over green to dark red.
Rgb turbo(double value);
/// Black to white.
Rgb gray(double value);
/// The colour of NaN.
Rgb no_value_color();

/// `color` times `light`, 0 to 1.
Rgb shaded(Rgb color, double light);

}  // namespace pointsweep
