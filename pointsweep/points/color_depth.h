// SPDX-License-Identifier: MIT
/// Colours of 8 bits (PLY, PCD; full brightness is 255) and of 16 bits (LAS; full brightness is 65535).
#pragma once

#include <optional>

#include "pointsweep/points/schema.h"

namespace pointsweep {

/// Returns whether red, green and blue are u16 fields with one unscaled value (Field::is_plain()).
bool has_wide_colors(const Schema& schema);

/// Returns `schema` with Field::scale 257 for red, green and blue, so that their 8-bit numbers stand for 16-bit
/// colours; nullopt if these are not three u8 fields with one unscaled value. The bytes of records stay as they are.
std::optional<Schema> with_wide_colors(const Schema& schema);

}  // namespace pointsweep
