// SPDX-License-Identifier: MIT
#include <cmath>
#include <nlohmann/json.hpp>

#include "pointsweep/fail.h"
#include "pointsweep/polygons/polygon_text.h"

namespace pointsweep {
namespace {

using GeoJson = nlohmann::json;

/// Takes geometries apart (RFC 7946, section 3).
class GeometryCollector {
 public:
  explicit GeometryCollector(std::string_view name) : name_(name) {}

  void add(const GeoJson& object) {
    const std::string type = type_of(object);
    if (type == "FeatureCollection") {
      for (const GeoJson& feature : member(object, "features")) add(feature);
    } else if (type == "Feature") {
      if (const GeoJson& geometry = member(object, "geometry"); !geometry.is_null()) add(geometry);
    } else if (type == "GeometryCollection") {
      for (const GeoJson& geometry : member(object, "geometries")) add(geometry);
    } else if (type == "MultiPolygon") {
      for (const GeoJson& polygon : member(object, "coordinates")) add_polygon(polygon);
    } else if (type == "Polygon") {
      add_polygon(member(object, "coordinates"));
    } else {
      fail("{}: holds a '{}'; give polygons only.", name_, type);
    }
  }

  std::vector<Polygon> polygons() && { return std::move(polygons_); }

 private:
  std::string type_of(const GeoJson& object) const {
    if (!object.is_object() || !object.contains("type") || !object["type"].is_string())
      fail("{}: holds an object without \"type\", so it is not GeoJSON.", name_);
    return object["type"].get<std::string>();
  }
  const GeoJson& member(const GeoJson& object, const char* key) const {
    if (!object.contains(key)) fail("{}: a {} has no \"{}\".", name_, object["type"].get<std::string>(), key);
    return object[key];
  }

  void add_polygon(const GeoJson& rings) {
    if (!rings.is_array()) fail_coordinates();
    Polygon polygon;
    for (const GeoJson& ring : rings) polygon.rings.push_back(ring_of(ring));
    if (!polygon.rings.empty()) polygons_.push_back(std::move(polygon));
  }

  Ring ring_of(const GeoJson& ring) const {
    if (!ring.is_array()) fail_coordinates();
    std::vector<Point2> points;
    for (const GeoJson& point : ring) {
      if (!point.is_array() || point.size() < 2 || !point[0].is_number() || !point[1].is_number()) fail_coordinates();
      points.push_back({point[0].get<double>(), point[1].get<double>()});
      if (!std::isfinite(points.back().x) || !std::isfinite(points.back().y)) fail_coordinates();
    }
    return closed_ring(std::move(points), name_);
  }

  [[noreturn]] void fail_coordinates() const {
    fail("{}: the coordinates of polygon {} are not rings of points [x, y].", name_, polygons_.size() + 1);
  }

  std::string_view name_;
  std::vector<Polygon> polygons_;
};

}  // namespace

std::vector<Polygon> polygons_of_geojson(std::string_view text, std::string_view name) {
  GeoJson json;
  try {
    json = GeoJson::parse(text);
  } catch (const GeoJson::exception& error) {
    fail("{}: is not JSON: {}.", name, error.what());
  }
  GeometryCollector collector(name);
  collector.add(json);
  return std::move(collector).polygons();
}

}  // namespace pointsweep
