// SPDX-License-Identifier: MIT
/// Fields for an array of a file that names arrays, not their components (VTK, NPZ).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pointsweep/points/schema.h"

namespace pointsweep {

/// Appends an array with `components` values a point to `schema` and returns the index of its first field. Three values
/// called xyz, points, position(s), vertices or coordinates become x, y, z; three floats called normal(s) nx, ny, nz;
/// three or four bytes called color(s), colour(s), rgb or rgba red, green, blue (and alpha). Another array is one field
/// of so many components under its own name. A name that is taken gets _2, _3, ...
std::size_t append_array(Schema& schema, const std::string& name, Type type, std::uint32_t components);

}  // namespace pointsweep
