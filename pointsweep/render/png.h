// SPDX-License-Identifier: MIT
/// Pictures as PNG.
#pragma once

#include <cstddef>
#include <vector>

#include "pointsweep/render/canvas.h"

namespace pointsweep {

/// A whole PNG file, 8 bits per channel, sRGB. Throws Error if the machine has no memory for it.
std::vector<std::byte> to_png(const Picture& picture);

}  // namespace pointsweep
