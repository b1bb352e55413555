// SPDX-License-Identifier: MIT
/// Coordinate reference systems as tuples of Python.
#pragma once

#include <nanobind/nanobind.h>

#include <optional>

#include "pointsweep/crs.h"

namespace pointsweep {

/// Returns (name, kind, EPSG code, EPSG code of the heights, WKT, and the directory, the doubles and the ASCII text of
/// the GeoTIFF keys); None if `crs` is absent.
nanobind::object crs_value(const std::optional<Crs>& crs);
/// Returns the system from which crs_value() made the tuple `value`; absent for None.
std::optional<Crs> crs_from(nanobind::handle value);

}  // namespace pointsweep
