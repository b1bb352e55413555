// SPDX-License-Identifier: MIT
/// The representation of the attributes of a record in E57.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/formats/e57/e57_file.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {

/// The name of an attribute in the library and in E57.
struct E57Name {
  std::string_view ours, theirs;
  std::string_view extension = "";  ///< extension that defines the name; empty for the standard
};

/// The attributes that E57 or its extension names, the coordinates first.
inline constexpr E57Name kE57Names[] = {
    {"x", "cartesianX"},
    {"y", "cartesianY"},
    {"z", "cartesianZ"},
    {"invalid_state", "cartesianInvalidState"},
    {"range", "sphericalRange"},
    {"azimuth", "sphericalAzimuth"},
    {"elevation", "sphericalElevation"},
    {"spherical_invalid_state", "sphericalInvalidState"},
    {"intensity", "intensity"},
    {"intensity_invalid", "isIntensityInvalid"},
    {"red", "colorRed"},
    {"green", "colorGreen"},
    {"blue", "colorBlue"},
    {"color_invalid", "isColorInvalid"},
    {"row", "rowIndex"},
    {"column", "columnIndex"},
    {"return_index", "returnIndex"},
    {"return_count", "returnCount"},
    {"time_stamp", "timeStamp"},
    {"time_stamp_invalid", "isTimeStampInvalid"},
    {"nx", "normalX", "nor"},
    {"ny", "normalY", "nor"},
    {"nz", "normalZ", "nor"},
};

/// Number of the Cartesian coordinates at the beginning of kE57Names.
inline constexpr std::size_t kE57Coordinates = 3;

/// One value of a point: an attribute of the file, and its place in a record.
struct E57Column {
  E57Attribute attribute;  ///< name "cartesianX", "nor:normalX", "ps:NAME"
  Field field;             ///< place of the value in a record; has one component

  /// Returns the number that the file stores: an integer without its scale, or the bits of a double.
  std::uint64_t stored(const std::byte* record) const;
};

/// Returns the columns for records of `schema`, the coordinates first, without `invalid_state`.
std::vector<E57Column> e57_columns(const Schema& schema);

/// Returns `name` with '_' instead of all characters except letters, digits, '-' and '_'. A name of the standard, or
/// one that XML does not allow, gets an '_' in front.
std::string e57_name(const std::string& name);

}  // namespace pointsweep
