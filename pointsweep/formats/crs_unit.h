// SPDX-License-Identifier: MIT
/// The unit of length of a coordinate reference system.
#pragma once

#include <optional>
#include <string>

#include "pointsweep/formats/crs.h"

namespace pointsweep {

/// "m", "ft" or "US survey ft", as the system's WKT or GeoTIFF keys state it; empty for degrees and for what they do
/// not state.
std::string length_unit_of(const Crs& crs);
/// The metres in that unit; absent where it is not known.
std::optional<double> metres_of_unit(const Crs& crs);

}  // namespace pointsweep
