// SPDX-License-Identifier: MIT
/// The colours of the standard classes of airborne scans.
#pragma once

#include <cstdint>

#include "pointsweep/colors/rgb.h"

namespace pointsweep {

/// The colour of a class of LAS 1.4. ASPRS names the classes and leaves their colours to programs; these follow common
/// viewers: ground brown, vegetation green, buildings red, water blue, noise magenta.
Rgb color_of_las_class(std::uint8_t code);

}  // namespace pointsweep
