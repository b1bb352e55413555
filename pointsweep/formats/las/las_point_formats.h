// SPDX-License-Identifier: MIT
/// The contents of the point records of LAS: the fields of point formats 0 to 10.
#pragma once

#include <cstdint>
#include <optional>

#include "pointsweep/geometry.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {

inline constexpr int kLasPointFormats = 11;
inline constexpr int kFirstModernLasFormat = 6;  ///< formats from here on are those of LAS 1.4

/// Bytes of a record of `point_format` without extra bytes; nothing for a format that LAS does not define.
std::optional<std::uint16_t> las_record_length(int point_format);

/// The fields of `point_format`, 0 to 10, under the library's names; stride is las_record_length(). x, y and z are
/// int32 with the scale and offset given; scan_angle is in degrees in all formats.
Schema las_point_schema(int point_format, Vec3 scale, Vec3 offset);

/// The first version, LAS 1.`minor`, that has `point_format`.
int las_minor_of(int point_format);
/// Returns whether records of the point format refer to waveforms.
bool las_has_waveforms(int point_format);

/// The place of the return number in a record: the low bits of byte 14, under this mask.
inline constexpr std::uint32_t kLasReturnByte = 14;
inline std::uint8_t las_return_mask(int point_format) { return point_format >= 6 ? 0x0F : 0x07; }

}  // namespace pointsweep
