// SPDX-License-Identifier: MIT
/// Polygons in text: WKT and GeoJSON.
#pragma once

#include <string_view>
#include <vector>

#include "pointsweep/polygons/polygon_index.h"

namespace pointsweep {

/// Parses any number of geometries POLYGON and MULTIPOLYGON with two to four numbers per point, of which x and y are
/// used; each geometry may have a leading "SRID=...;". Throws Error that begins with `name` and states the error and
/// the byte at which it is.
std::vector<Polygon> polygons_of_wkt(std::string_view text, std::string_view name);

/// Parses a Polygon, MultiPolygon, GeometryCollection of such geometries, Feature or FeatureCollection. Coordinates are
/// used unchanged in any reference system. Throws Error that begins with `name`.
std::vector<Polygon> polygons_of_geojson(std::string_view text, std::string_view name);

/// Returns whether `text` is WKT or GeoJSON itself and not the name of a file.
bool is_polygon_text(std::string_view text);

/// Parses WKT or GeoJSON. Throws Error unless the text holds a polygon that is not empty.
std::vector<Polygon> polygons_of_text(std::string_view text, std::string_view name);

/// Makes a Ring of the points of a ring in a file, where the last point repeats the first. Throws Error for fewer than
/// four points and for a ring that is not closed. `where`: name of the ring in messages.
Ring closed_ring(std::vector<Point2> points, std::string_view where);

}  // namespace pointsweep
