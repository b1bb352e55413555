// SPDX-License-Identifier: MIT
/// The properties of all values of a cloud that must be known before its first point is stored as LAS.
#pragma once

#include <cstdint>
#include <functional>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/formats/known_values.h"

namespace pointsweep {

/// Reads the cloud once if the types of its fields leave open which point format holds them, or if real coordinates may
/// lie on the grid of the LAS file that they came from, or of decimal fractions such as text files have. `progress`
/// gets the number of points read; it may throw.
KnownValues las_values(InputCloud& cloud, const std::function<void(std::uint64_t)>& progress);

}  // namespace pointsweep
