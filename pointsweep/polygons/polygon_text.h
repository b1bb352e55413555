// SPDX-License-Identifier: MIT
/// Polygons as files have them: WKT and GeoJSON.
#pragma once

#include <string_view>
#include <vector>

#include "pointsweep/polygons/polygon_index.h"

namespace pointsweep {

/// Parses POLYGON and MULTIPOLYGON, with two to four numbers per point, of which x and y are used; several may follow
/// one another, each with or without a leading "SRID=...;". Throws Error that begins with `name` and states the error
/// and its byte.
std::vector<Polygon> polygons_of_wkt(std::string_view text, std::string_view name);

/// Parses a Polygon, MultiPolygon, GeometryCollection of these, Feature or FeatureCollection. Coordinates are used
/// unchanged in any reference system. Throws Error that begins with `name`.
std::vector<Polygon> polygons_of_geojson(std::string_view text, std::string_view name);

/// Returns whether `text` is WKT or GeoJSON itself and not the name of a file.
bool is_polygon_text(std::string_view text);

/// Parses WKT or GeoJSON. Throws unless there is a polygon that is not empty.
std::vector<Polygon> polygons_of_text(std::string_view text, std::string_view name);

/// Converts the points of a ring in a file, where the first point is repeated at the end. `where`: for messages.
Ring closed_ring(std::vector<Point2> points, std::string_view where);

}  // namespace pointsweep
