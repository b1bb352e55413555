// SPDX-License-Identifier: MIT
/// The names of attributes in E57 and in the library.
#pragma once

#include <cstddef>
#include <string_view>

namespace pointsweep {

struct E57Name {
  std::string_view ours, theirs;
  std::string_view extension = "";  ///< that defines the name; empty: the standard
};

/// The coordinates come first.
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
inline constexpr std::size_t kE57Coordinates = 3;

}  // namespace pointsweep
