// SPDX-License-Identifier: MIT
/// Colours of 8 bits (PLY, PCD) and of 16 bits (LAS). Full brightness is 255 and 65535.
#pragma once

#include <optional>

#include "pointsweep/points/schema.h"

namespace pointsweep {

/// Returns whether red, green and blue are plain fields of 16 bits.
bool has_wide_colors(const Schema& schema);

/// Returns `schema` with its 8-bit red, green and blue scaled to 16 bits by a factor of 257; nothing if they are not
/// three plain fields of 8 bits. Only the types of the fields decide, never the values.
std::optional<Schema> with_wide_colors(const Schema& schema);

}  // namespace pointsweep
