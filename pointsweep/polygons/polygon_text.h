// SPDX-License-Identifier: MIT
/// Polygons in text: WKT and GeoJSON.
#pragma once

#include <string_view>
#include <vector>

#include "pointsweep/polygons/polygon_index.h"

namespace pointsweep {

/// Returns whether `text` is WKT or GeoJSON itself and not the name of a file.
bool is_polygon_text(std::string_view text);

/// Parses WKT: any number of geometries POLYGON and MULTIPOLYGON with two to four numbers per point, of which x and y
/// are used; each geometry may have a leading "SRID=...;". Or parses GeoJSON: a Polygon, MultiPolygon,
/// GeometryCollection of such geometries, Feature or FeatureCollection. Coordinates are used unchanged in any reference
/// system. Throws Error that begins with `name` for an invalid text, in WKT with the byte at which it is invalid, and
/// for a text whose polygons are all empty.
std::vector<Polygon> polygons_of_text(std::string_view text, std::string_view name);

}  // namespace pointsweep
