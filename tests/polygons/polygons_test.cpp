// SPDX-License-Identifier: MIT
/// Points in polygons, against whole-number arithmetic over all edges; polygons in files.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "pointsweep/error.h"
#include "pointsweep/polygons/polygon_index.h"
#include "pointsweep/polygons/polygon_text.h"
#include "pointsweep/verify/formulas/regions.h"

namespace pointsweep {
namespace {

__extension__ typedef __int128 Integer;

/// Corners and points with whole coordinates.
struct Place {
  std::int64_t x = 0, y = 0;
};

int sign_of(Integer v) { return v > 0 ? 1 : v < 0 ? -1 : 0; }

int whole_orientation(Place a, Place b, Place c) {
  return sign_of(Integer{a.x - c.x} * Integer{b.y - c.y} - Integer{a.y - c.y} * Integer{b.x - c.x});
}

TEST(Orientation, EqualsThatOfWholeNumbersAtEveryScale) {
  std::mt19937_64 random(1);
  for (const int bits : {2, 20, 52}) {
    for (const int scale : {0, -1074, -600, 300, 970}) {
      for (int turn = 0; turn < 2000; ++turn) {
        const auto coordinate = [&] {
          return static_cast<std::int64_t>(random() >> (64 - bits)) - (1 << (bits > 20 ? 20 : bits - 1));
        };
        const Place a{coordinate(), coordinate()}, b{coordinate(), coordinate()};
        // c lies on the line or one unit off it, where the determinant is 0 or tiny compared with its products.
        Place c{2 * b.x - a.x, 2 * b.y - a.y};
        if (turn % 3 == 1) c.x += 1;
        if (turn % 3 == 2) c = {coordinate(), coordinate()};
        if (turn % 4 == 3) {  // as near to the line as whole numbers allow: float64 products leave the side open
          const double t = static_cast<double>(random() >> 11) / 0x1p53;
          c = {a.x + std::llround(t * static_cast<double>(b.x - a.x)),
               a.y + std::llround(t * static_cast<double>(b.y - a.y))};
        }
        const auto real = [&](Place p) {
          return Point2{std::ldexp(static_cast<double>(p.x), scale), std::ldexp(static_cast<double>(p.y), scale)};
        };
        ASSERT_EQ(orientation(real(a), real(b), real(c)), whole_orientation(a, b, c))
            << bits << " " << scale << " " << turn;
      }
    }
  }
}

/// Kettner et al., "Classroom examples of robustness problems in geometric computations" (2008): here differences of
/// coordinates round, so that float64 gives wrong signs, not only zeros.
TEST(Orientation, IsRightWhereDifferencesOfCoordinatesRound) {
  for (int i = 0; i < 256; ++i)
    for (int j = 0; j < 256; ++j) {
      const Point2 p{0.5 + i * 0x1p-53, 0.5 + j * 0x1p-53};
      ASSERT_EQ(orientation({12, 12}, {24, 24}, p), (j > i) - (j < i)) << i << " " << j;
    }
}

TEST(Orientation, SeesTheLastBitOfCoordinatesOfAnyMagnitude) {
  const double tiny = std::numeric_limits<double>::denorm_min(), huge = std::numeric_limits<double>::max();
  EXPECT_EQ(orientation({0, 0}, {tiny, tiny}, {tiny, 0}), -1);
  EXPECT_EQ(orientation({-huge, -huge}, {huge, huge}, {0.5, 0.5}), 0);
  EXPECT_EQ(orientation({-huge, -huge}, {huge, huge}, {0.5, std::nextafter(0.5, 1)}), 1);
  EXPECT_EQ(orientation({-huge, -huge}, {huge, huge}, {tiny, 0}), -1);
  EXPECT_EQ(orientation({0, 0}, {3, 1}, {0.3, 0.1}), 1);  // as doubles, 3 * 0.1 > 0.3
}

using WholeRings = std::vector<std::vector<Place>>;

/// Returns whether p lies inside by the even-odd rule over all edges, or on an edge.
bool is_covered(const std::vector<WholeRings>& polygons, Place p) {
  for (const WholeRings& rings : polygons) {
    bool inside = false, on_edge = false;
    for (const auto& ring : rings) {
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const Place a = ring[i], b = ring[(i + 1) % ring.size()];
        const int side = whole_orientation(a, b, p);
        on_edge |= side == 0 && p.x >= std::min(a.x, b.x) && p.x <= std::max(a.x, b.x) && p.y >= std::min(a.y, b.y) &&
                   p.y <= std::max(a.y, b.y);
        if ((a.y > p.y) != (b.y > p.y)) inside ^= (b.y > a.y) == (side > 0);
      }
    }
    if (inside || on_edge) return true;
  }
  return false;
}

/// Returns polygons with corners in a coarse grid: edges that touch, cross, repeat or are horizontal, rings without
/// area, holes outside.
std::vector<WholeRings> random_polygons(std::mt19937_64& random) {
  std::vector<WholeRings> polygons(1 + random() % 3);
  const std::int64_t grid = random() % 2 == 0 ? 6 : 40;
  for (WholeRings& rings : polygons) {
    rings.resize(1 + random() % 3);
    for (auto& ring : rings) {
      ring.resize(3 + random() % (random() % 4 == 0 ? 40 : 6));
      for (Place& p : ring)
        p = {static_cast<std::int64_t>(random() % grid), static_cast<std::int64_t>(random() % grid)};
    }
  }
  return polygons;
}

TEST(PolygonIndex, CoversWhatEveryEdgeTogetherSays) {
  std::mt19937_64 random(2);
  std::size_t covered = 0, asked = 0;
  for (int turn = 0; turn < 400; ++turn) {
    const std::vector<WholeRings> polygons = random_polygons(random);
    // Whole numbers times 2^-3, at the offset of a national grid: coordinates are exact in double, but their products
    // are not.
    const double offset = turn % 2 == 0 ? 0 : 5234567.125;
    const auto real = [&](std::int64_t v) { return offset + static_cast<double>(v) / 8; };
    std::vector<Polygon> converted;
    std::vector<formulas::PolygonRings> plain;
    for (const WholeRings& rings : polygons) {
      converted.emplace_back(), plain.emplace_back();
      for (const auto& ring : rings) {
        converted.back().rings.emplace_back(), plain.back().emplace_back();
        for (const Place& p : ring) {
          converted.back().rings.back().push_back({real(p.x), real(p.y)});
          plain.back().back().push_back({real(p.x), real(p.y)});
        }
      }
    }
    const PolygonIndex index(converted);
    const formulas::EdgesAlongX edges(plain);
    for (std::int64_t x = -1; x <= 41; ++x) {
      const Place p{x, static_cast<std::int64_t>(random() % 43) - 1};
      const bool expected = is_covered(polygons, p);
      ASSERT_EQ(index.covers({real(p.x), real(p.y)}), expected) << turn << ": " << p.x << " " << p.y;
      ASSERT_EQ(edges.hold({real(p.x), real(p.y)}), expected) << turn << ": " << p.x << " " << p.y;
      covered += expected, ++asked;
    }
  }
  EXPECT_GT(covered, asked / 20);
}

TEST(PolygonIndex, OfManyEdgesAcrossAllHeightsStaysSmallAndExact) {
  Ring comb;  // teeth from bottom to top
  const int teeth = 20'000;
  for (int i = 0; i < teeth; ++i) comb.push_back({2.0 * i, 0}), comb.push_back({2.0 * i + 1, 1000});
  comb.push_back({2.0 * teeth, -1}), comb.push_back({-1, -1});
  const PolygonIndex index({{{comb}}});
  EXPECT_TRUE(index.covers({2, -0.5}));
  EXPECT_TRUE(index.covers({1, 1000}));
  EXPECT_TRUE(index.covers({1, 999.5}));
  EXPECT_FALSE(index.covers({2, 999.5}));
  EXPECT_FALSE(index.covers({1, std::nextafter(1000, 2000)}));
}

TEST(PolygonIndex, NoPointWithoutAPlaceIsCovered) {
  const PolygonIndex index({{{{{0, 0}, {9, 0}, {9, 9}}}}});
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN(), kFar = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(index.covers({5, 2}));
  for (const double v : {kNone, kFar, -kFar}) {
    EXPECT_FALSE(index.covers({v, 2}));
    EXPECT_FALSE(index.covers({5, v}));
  }
}

std::string refused_text(const std::string& text) {
  try {
    polygons_of_text(text, "area");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(PolygonText, WktAndGeoJsonGiveTheSamePolygons) {
  const std::vector<Polygon> expected = {{{{{0, 0}, {9, 0}, {9, 9}}, {{1, 1}, {2, 1}, {2, 1.5}}}},
                                         {{{{-1e3, 20}, {30, 20}, {30, 30.25}}}}};
  for (const char* text :
       {"MULTIPOLYGON (((0 0, 9 0, 9 9, 0 0), (1 1, 2 1, 2 1.5, 1 1)), ((-1e3 20, 30 20, +30 30.25, -1000 20)))",
        "  polygon((0 0,9 0,9 9,0 0),(1 1,2 1,2 1.5,1 1))\nSRID=25832;Polygon Z ((-1000 20 5, 30 20 5, 30 30.25 5, "
        "-1000 20 5))\n",
        "POLYGONZM ((0 0 1 2, 9 0 1 2, 9 9 1 2, 0 0 1 2),(1 1,2 1,2 1.5,1 1)) POLYGON EMPTY MULTIPOLYGON Z (((-1e3 20 "
        "0, "
        "30 20 0, 30 30.25 0, -1e3 20 0)))",
        R"({"type": "MultiPolygon", "coordinates": [[[[0,0],[9,0],[9,9],[0,0]],[[1,1],[2,1],[2,1.5],[1,1]]],
            [[[-1e3,20],[30,20],[30,30.25],[-1e3,20]]]]})",
        R"({"type": "FeatureCollection", "features": [
            {"type": "Feature", "properties": {"a": 1}, "geometry":
              {"type": "Polygon", "coordinates": [[[0,0,7],[9,0,7],[9,9,7],[0,0,7]],[[1,1],[2,1],[2,1.5],[1,1]]]}},
            {"type": "Feature", "geometry": null},
            {"type": "Feature", "geometry": {"type": "GeometryCollection", "geometries": [
              {"type": "Polygon", "coordinates": [[[-1000,20],[30,20],[30,30.25],[-1000,20]]]}]}}]})"}) {
    EXPECT_EQ(polygons_of_text(text, "area"), expected) << text;
    EXPECT_TRUE(is_polygon_text(text)) << text;
  }
  EXPECT_EQ(polygons_of_text("\xEF\xBB\xBFPOLYGON((0 0,9 0,9 9,0 0))", "area").size(), 1u);
  EXPECT_TRUE(is_polygon_text("SRID=2154;POLYGON((0 0,9 0,9 9,0 0))"));
  EXPECT_TRUE(is_polygon_text(" srid=2154; multipolygon empty (")) << "the parser says what is wrong";
  for (const char* name :
       {"polygon.wkt", "area.json", "POLYGON", "polygons/a (1).txt", "", "SRID", "SRID=1;", "srid.wkt"})
    EXPECT_FALSE(is_polygon_text(name));
}

TEST(PolygonText, ErrorsSayWhatIsWrongAndWhere) {
  const std::pair<const char*, const char*> wrong[] = {
      {"POLYGON ((0 0, 9 0, 9 9, 0 1))", "area: byte 10: a ring ends at 0 1, not where it begins, at 0 0"},
      {"POLYGON ((0 0, 9 0, 0 0))", "a ring has 3 points; one has at least four"},
      {"POLYGON ((0 0, 9 x, 9 9, 0 0))", "byte 18: a number is expected, not 'x'"},
      {"POLYGON ((0 0, 9 inf, 9 9, 0 0))", "byte 18: a number is expected"},
      {"POLYGON ((0 0, 9 0, 9 9, 0 0)", "',' or ')' is expected, but the text ends"},
      {"LINESTRING (0 0, 1 1)", "byte 1: POLYGON or MULTIPOLYGON is expected, not 'L'"},
      {"POLYGON X ((0 0, 9 0, 9 9, 0 0))", "byte 9: '(' is expected, not 'X'"},
      {"POLYGON EMPTY", "area: holds no polygon"},
      {"", "area: holds no polygon"},
      {"{\"type\": \"Point\", \"coordinates\": [0, 0]}", "holds a 'Point'; give polygons only"},
      {"{\"type\": \"Polygon\"}", "a Polygon has no \"coordinates\""},
      {"{\"type\": \"Polygon\", \"coordinates\": [[[0,0],[1],[1,1],[0,0]]]}", "polygon 1 are not rings of points"},
      {"{\"type\": \"Polygon\", \"coordinates\": [[[0,0],[1,0],[1,1],[0,0.5]]]}", "a ring ends at 0 0.5, not where"},
      {"{\"type\": \"Polygon\", \"coordinates\": 7}", "are not rings of points"},
      {"{\"typ\": 1}", "without \"type\""},
      {"{\"type\": ", "is not JSON"}};
  for (const auto& [text, words] : wrong)
    EXPECT_NE(refused_text(text).find(words), std::string::npos) << text << "\n" << refused_text(text);
}

TEST(PolygonText, GeometriesInsideEachOtherDoNotUseUpTheStack) {
  const std::string text = R"({"type": "Polygon", "coordinates": [[[0,0],[1,0],[1,1],[0,0]]]})";
  const auto nest = [&](int times) {
    std::string begin, end;
    for (int i = 0; i < times; ++i) begin += R"({"type": "GeometryCollection", "geometries": [)", end += "]}";
    return begin + text + end;
  };
  EXPECT_EQ(polygons_of_text(nest(100), "area").size(), 1u);
  EXPECT_NE(refused_text(nest(101)).find("area: has more than 100 geometries inside each other"), std::string::npos);
  EXPECT_NE(refused_text(nest(200'000)).find("more than 100 geometries"), std::string::npos);
}

}  // namespace
}  // namespace pointsweep
