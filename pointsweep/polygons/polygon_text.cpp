// SPDX-License-Identifier: MIT
#include "pointsweep/polygons/polygon_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";

char upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }
bool is_letter(char c) { return upper(c) >= 'A' && upper(c) <= 'Z'; }

/// Makes a Ring of the points of a ring in a file, where the last point repeats the first. Throws Error for fewer than
/// four points and for a ring that is not closed. `where`: beginning of the messages.
Ring closed_ring(std::vector<Point2> points, std::string_view where) {
  if (points.size() < 4)
    fail("{}: a ring has {} points; one has at least four, of which the last is the first again.", where,
         points.size());
  if (points.front() != points.back())
    fail("{}: a ring ends at {} {}, not where it begins, at {} {}.", where, points.back().x, points.back().y,
         points.front().x, points.front().y);
  points.pop_back();
  return points;
}

/// A recursive-descent parser of WKT with this grammar:
///   text = {["SRID=" number ";"] geometry}     geometry = ("POLYGON" | "MULTIPOLYGON") ["Z" | "M" | "ZM"] shape
///   shape of a polygon = "EMPTY" | "(" ring {"," ring} ")"     ring = "(" point {"," point} ")"
///   point = number number [number [number]]
///   shape of a multipolygon = "EMPTY" | "(" shape of a polygon {"," shape of a polygon} ")"
class WktParser {
 public:
  WktParser(std::string_view text, std::string_view name) : text_(text), name_(name) {}

  std::vector<Polygon> polygons() {
    while (skip_blanks(), at_ < text_.size()) geometry();
    return std::move(polygons_);
  }

 private:
  void geometry() {
    std::string word = this->word();
    if (word == "SRID" && take('=')) {
      number();
      if (!take(';')) expected("';'");
      word = this->word();
    }
    for (const char* dimensions : {"ZM", "Z", "M"})
      if ((word == std::string("POLYGON") + dimensions || word == std::string("MULTIPOLYGON") + dimensions))
        word.resize(word.size() - std::string_view(dimensions).size());
    if (word != "POLYGON" && word != "MULTIPOLYGON") {
      at_ -= word.size();
      expected("POLYGON or MULTIPOLYGON");
    }
    if (word == "POLYGON") return shape();
    if (is_empty()) return;
    list([&] { shape(); });
  }

  void shape() {
    if (is_empty()) return;
    Polygon polygon;
    list([&] { polygon.rings.push_back(ring()); });
    polygons_.push_back(std::move(polygon));
  }

  Ring ring() {
    skip_blanks();
    const std::string where = fmt::format("{}: byte {}", name_, at_ + 1);
    std::vector<Point2> points;
    list([&] {
      const double x = number(), y = number();
      points.push_back({x, y});
      for (int more = 0; more < 2 && begins_number(); ++more) number();
    });
    return closed_ring(std::move(points), where);
  }

  template <class Part>
  void list(Part part) {
    if (!take('(')) expected("'('");
    do {
      part();
    } while (take(','));
    if (!take(')')) expected("',' or ')'");
  }

  /// Skips the dimensions (Z, M or ZM) that may stand before a shape, and EMPTY. Returns whether it has read EMPTY.
  bool is_empty() {
    std::string word = this->word();
    if (word == "Z" || word == "M" || word == "ZM") word = this->word();
    if (!word.empty() && word != "EMPTY") {
      at_ -= word.size();
      expected("'('");
    }
    return word == "EMPTY";
  }

  std::string word() {
    skip_blanks();
    std::string word;
    while (at_ < text_.size() && is_letter(text_[at_])) word += upper(text_[at_++]);
    return word;
  }

  bool begins_number() {
    skip_blanks();
    return at_ < text_.size() && text_[at_] != ',' && text_[at_] != ')';
  }

  double number() {
    skip_blanks();
    double value = 0;
    if (at_ < text_.size() && text_[at_] == '+') ++at_;
    const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (error != std::errc() || !std::isfinite(value)) expected("a number");
    at_ = static_cast<std::size_t>(end - text_.data());
    return value;
  }

  bool take(char c) {
    skip_blanks();
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  void skip_blanks() { at_ = std::min(text_.find_first_not_of(kBlanks, at_), text_.size()); }

  [[noreturn]] void expected(std::string_view what) const {
    if (at_ >= text_.size()) fail("{}: {} is expected, but the text ends.", name_, what);
    fail("{}: byte {}: {} is expected, not '{}'; a polygon looks like POLYGON ((0 0, 9 0, 9 9, 0 0)).", name_, at_ + 1,
         what, text_[at_]);
  }

  std::string_view text_, name_;
  std::size_t at_ = 0;
  std::vector<Polygon> polygons_;
};

std::string_view without_leading_blanks(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  return text.substr(std::min(text.find_first_not_of(kBlanks), text.size()));
}

using GeoJson = nlohmann::json;

/// Collects the polygons of nested geometries (RFC 7946, section 3).
class GeometryCollector {
 public:
  explicit GeometryCollector(std::string_view name) : name_(name) {}

  /// Adds the polygons of an object that lies in `depth` other objects. The limit of the depth keeps the recursion from
  /// using up the stack.
  void add(const GeoJson& object, int depth = 0) {
    if (depth > kMostDepth) fail("{}: has more than {} geometries inside each other.", name_, kMostDepth);
    const std::string type = type_of(object);
    if (type == "FeatureCollection") {
      for (const GeoJson& feature : member(object, "features")) add(feature, depth + 1);
    } else if (type == "Feature") {
      if (const GeoJson& geometry = member(object, "geometry"); !geometry.is_null()) add(geometry, depth + 1);
    } else if (type == "GeometryCollection") {
      for (const GeoJson& geometry : member(object, "geometries")) add(geometry, depth + 1);
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
  static constexpr int kMostDepth = 100;

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

}  // namespace

bool is_polygon_text(std::string_view text) {
  text = without_leading_blanks(text);
  if (text.starts_with('{')) return true;
  std::string letters;
  for (const char c : text.substr(0, 4)) letters += upper(c);
  if (letters == "SRID") text = without_leading_blanks(text.substr(std::min(text.find(';'), text.size() - 1) + 1));
  letters.clear();
  while (!text.empty() && text.front() != '(' &&
         (is_letter(text.front()) || kBlanks.find(text.front()) != kBlanks.npos))
    letters += upper(text.front()), text.remove_prefix(1);
  return text.starts_with('(') && (letters.starts_with("POLYGON") || letters.starts_with("MULTIPOLYGON"));
}

std::vector<Polygon> polygons_of_text(std::string_view text, std::string_view name) {
  text = without_leading_blanks(text);
  std::vector<Polygon> polygons =
      text.starts_with('{') ? polygons_of_geojson(text, name) : WktParser(text, name).polygons();
  if (polygons.empty()) fail("{}: holds no polygon.", name);
  return polygons;
}

}  // namespace pointsweep
