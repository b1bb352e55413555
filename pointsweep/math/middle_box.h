// SPDX-License-Identifier: MIT
/// The extent of a cloud without its outliers.
#pragma once

#include <span>

#include "pointsweep/math/box.h"

namespace pointsweep {

/// Returns the box of the middle 98 % of each coordinate of a sample. The sample must not be empty.
Box middle_box(std::span<const Vec3> sample);

}  // namespace pointsweep
