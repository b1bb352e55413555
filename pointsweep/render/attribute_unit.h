// SPDX-License-Identifier: MIT
/// Units of attributes whose names say what they are.
#pragma once

#include <string>
#include <string_view>

namespace pointsweep {

/// Returns the unit: "1/m" for a curvature, "s" for gps_time, empty for what has no unit or is not known. `length` is
/// the unit of the cloud's coordinates, e.g. "m"; empty: not known, then "file unit" stands for it.
std::string unit_of_attribute(std::string_view name, std::string_view length);

}  // namespace pointsweep
