// SPDX-License-Identifier: MIT
/// The contents of the point records of LAS: the fields of point formats 0 to 10, and the choice of the point format
/// that holds the attributes of a cloud.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pointsweep/formats/known_values.h"
#include "pointsweep/geometry.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {

inline constexpr int kLasPointFormats = 11;
inline constexpr int kFirstModernLasFormat = 6;  ///< formats from 6 on belong to LAS 1.4

/// Returns the size of a record of `point_format` without extra bytes; none for a format that LAS does not define.
std::optional<std::uint16_t> las_record_length(int point_format);

/// Returns the fields of `point_format`, 0 to 10, under the library's names; stride is las_record_length(). x, y and z
/// are int32 with this scale and offset; scan_angle is in degrees in all formats.
Schema las_point_schema(int point_format, Vec3 scale = {1, 1, 1}, Vec3 offset = {});

/// Returns the first version, LAS 1.`minor`, that has `point_format`.
int las_minor_of(int point_format);
/// Returns whether records of the point format refer to waveforms.
bool las_has_waveforms(int point_format);

bool las_has_time(int point_format);

/// Byte offset of the return number in a record; las_return_mask() selects its bits.
inline constexpr std::uint32_t kLasReturnByte = 14;
/// Byte offset of the GPS time in a record of point formats 6 to 10.
inline constexpr std::size_t kLasModernTimeAt = 22;
inline std::uint8_t las_return_mask(int point_format) { return point_format >= 6 ? 0x0F : 0x07; }

/// Returns whether some point format has a field of the name, other than x, y and z.
bool is_las_name(const std::string& name);

/// Returns the names of the fields of one value in `schema` that point formats have, without x, y and z. Colours count
/// only if red, green and blue are all there, and waveform packets only with all of their fields.
std::vector<std::string> las_names_in(const Schema& schema);

/// Returns whether `target`, a field of a point format, holds every value of `source` in `range` exactly. A scan angle
/// may be rounded to the steps of 0.006 degrees.
bool las_field_holds(const Field& target, const Field& source, const ValueRange& range);

/// The point formats among which choose_las_point_format() chooses.
struct LasChoice {
  std::optional<int> format = {};  ///< the only format allowed
  bool legacy = false;             ///< formats 0 to 5 are allowed
  int most_minor = 4;              ///< all allowed formats exist in LAS 1.`most_minor`
  /// Returns whether the user has stated the format or the version. A stated format may lack fields of the cloud.
  bool is_stated() const { return format.has_value() || most_minor < 4; }
  bool has(int point_format) const;
};

/// Returns the point format of `choice` that holds the most fields of las_names_in(schema); of several such formats,
/// the format with the shortest records. `ranges` has one entry for each field of `schema`.
int choose_las_point_format(const Schema& schema, const std::vector<ValueRange>& ranges, const LasChoice& choice);

/// Returns the indices of fields whose values must be read, since their types do not decide whether the allowed point
/// formats hold them. If the choice is stated, includes fields that the allowed formats do not have.
std::vector<std::size_t> undecided_las_fields(const Schema& schema, const std::vector<ValueRange>& ranges,
                                              const LasChoice& choice);

}  // namespace pointsweep
