// SPDX-License-Identifier: MIT
/// Polygons as files have them: WKT and GeoJSON.
#pragma once

#include <string_view>
#include <vector>

#include "pointsweep/polygons/polygon_index.h"

namespace pointsweep {

/// POLYGON and MULTIPOLYGON, with two to four numbers for a point, of which x and y count; several may follow one
/// another, each with or without a leading "SRID=...;". Throws Error that begins with `name` and says at which byte
/// what is wrong.
std::vector<Polygon> polygons_of_wkt(std::string_view text, std::string_view name);

/// A Polygon, MultiPolygon, GeometryCollection of these, Feature or FeatureCollection. Coordinates are taken as they
/// are, whatever the reference system. Throws Error that begins with `name`.
std::vector<Polygon> polygons_of_geojson(std::string_view text, std::string_view name);

/// Returns whether `text` is WKT or GeoJSON itself and not the name of a file.
bool is_polygon_text(std::string_view text);

/// One or the other; at least one polygon that is not empty.
std::vector<Polygon> polygons_of_text(std::string_view text, std::string_view name);

/// Takes the points of a ring as files have it, its first point again at the end. `where`: for messages.
Ring closed_ring(std::vector<Point2> points, std::string_view where);

}  // namespace pointsweep
