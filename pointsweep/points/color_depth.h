// SPDX-License-Identifier: MIT
/// Colours of 8 bits (PLY, PCD) and of 16 bits (LAS). Full brightness is 255 and 65535.
#pragma once

#include <optional>

#include "pointsweep/points/schema.h"

namespace pointsweep {

/// True if red, green and blue are plain fields of 16 bits.
bool has_wide_colors(const Schema& schema);

/// `schema`, read with the brightness of 16 bits: the values of its red, green and blue of 8 bits are those that are
/// stored times 257. Absent if these are not three plain fields of 8 bits. The type alone decides, never the values.
std::optional<Schema> with_wide_colors(const Schema& schema);

}  // namespace pointsweep
