// SPDX-License-Identifier: MIT
/// Polygons in text: WKT and GeoJSON.
#pragma once

#include <string_view>
#include <vector>

#include "pointsweep/polygons/polygon_index.h"

namespace pointsweep {

/// Returns whether `text` begins like WKT or GeoJSON, so that it is not the name of a file: with '{', or, after an
/// optional "SRID=...;", with POLYGON or MULTIPOLYGON and '(', other letters and blanks between them allowed.
bool is_polygon_text(std::string_view text);

/// Parses WKT: any number of geometries POLYGON and MULTIPOLYGON with two to four numbers per point, of which x and y
/// are used; each geometry may have a leading "SRID=...;". Or parses GeoJSON: a Polygon, MultiPolygon,
/// GeometryCollection of such geometries, Feature or FeatureCollection. Coordinates are used unchanged in any reference
/// system. Throws Error that begins with `name` for an invalid text and for a text without a polygon that is not empty.
/// For WKT the message has the byte of the fault, or of the beginning of a wrong ring, unless the text ends too early.
std::vector<Polygon> polygons_of_text(std::string_view text, std::string_view name);

}  // namespace pointsweep
