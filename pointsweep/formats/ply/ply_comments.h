// SPDX-License-Identifier: MIT
/// Comments of PLY headers that keep what PLY has no place for, so that LAS -> PLY -> LAS loses nothing.
///
///     comment crs PROJCS["NAD83 / UTM zone 10N",...    the WKT; longer than 900 bytes, it continues in the next `crs`
///     comment crs_geotiff_keys 1 1 0 3 1024 0 1 1 ...  GeoKeyDirectoryTag
///     comment crs_geotiff_doubles 6378137 298.25       GeoDoubleParamsTag
///     comment crs_geotiff_ascii NAD83|                 GeoAsciiParamsTag; all but visible characters as %XX
///     comment las scale 0.01 0.01 0.01 offset 500000 0 0 gps_time standard
///                                                      of a LAS input; gps_time standard or week, if there are times
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pointsweep/formats/crs.h"
#include "pointsweep/formats/las_scale.h"

namespace pointsweep {

/// Lines that begin with `comment` and have at most 1,000 bytes, which the readers of other programs accept.
std::vector<std::string> crs_comments(const Crs& crs);

/// The system that such lines state; they are removed from `lines`. Lines that do not make sense stay.
std::optional<Crs> take_crs_comments(std::vector<std::string>& lines);

/// A line, as above, that states the meaning of the coordinates and times of a LAS file.
std::string las_comment(const LasOrigin& origin);
std::optional<LasOrigin> take_las_comment(std::vector<std::string>& lines);

}  // namespace pointsweep
