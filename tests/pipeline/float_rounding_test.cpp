// SPDX-License-Identifier: MIT
/// The stated bound on the rounding of coordinates, against the rounding of each coordinate.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "pointsweep/pipeline/output/output_warnings.h"
#include "pointsweep/pipeline/plan/output_layout.h"

namespace pointsweep {
namespace {

Schema positions_of(Type type) {
  Schema schema;
  for (const char* axis : {"x", "y", "z"}) schema.append(axis, type);
  return schema;
}

std::vector<std::byte> as_floats(const std::vector<Vec3>& points) {
  std::vector<float> values;
  for (const Vec3 p : points)
    for (int a = 0; a < 3; ++a) values.push_back(static_cast<float>(p[a]));
  const auto bytes = std::as_bytes(std::span(values));
  return {bytes.begin(), bytes.end()};
}

std::string said(const std::vector<Vec3>& points, Type input = Type::f64, Type output = Type::f32) {
  FloatRounding rounding(positions_of(input), {}, positions_of(output));
  rounding.see(as_floats(points));
  return rounding.sentence();
}

double number_after(const std::string& text, const std::string& words) {
  const std::size_t at = text.find(words);
  return at == text.npos ? -1 : std::stod(text.substr(at + words.size()));
}

double largest_change(const std::vector<Vec3>& points, Vec3 move) {
  double largest = 0;
  for (const Vec3 p : points)
    for (int a = 0; a < 3; ++a) {
      const double moved = p[a] + move[a];
      largest = std::max(largest, std::abs(static_cast<double>(static_cast<float>(moved)) - moved));
    }
  return largest;
}

TEST(FloatRounding, IsAtMostWhatIsSaidAndTheMoveHelpsAsMuchAsItIsSaidTo) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const Vec3 corner : {Vec3{684000, 5403000, 250}, Vec3{-3e6, 12, 4.2e6}, Vec3{0, 0, 0}, Vec3{7.51, 52.13, 0},
                            Vec3{8388607, 16777215, 0}, Vec3{-1e-3, 1e-3, 0}})
    for (const double size : {1e-3, 1.0, 320.0, 12345.0}) {
      std::vector<Vec3> points(500);
      for (Vec3& p : points) p = corner + size * Vec3{unit(random), unit(random), unit(random)};
      const std::string sentence = said(points);
      const double most = number_after(sentence, "rounds them by at most "), is = largest_change(points, {});
      EXPECT_GE(most * 1.05, is) << sentence;  // the sentence has two digits
      if (size >= 1) {                         // smaller clouds lie within a step of float32
        EXPECT_LE(most, 16 * is) << sentence;
      }
      const std::size_t at = sentence.find("translate=[");
      if (at == sentence.npos) continue;
      Vec3 move;
      ASSERT_EQ(std::sscanf(sentence.c_str() + at, "translate=[%lf, %lf, %lf]", &move.x, &move.y, &move.z), 3);
      const double then = number_after(sentence, "would round them by at most ");
      EXPECT_GE(then * 1.05, largest_change(points, move)) << sentence;
      EXPECT_LT(largest_change(points, move), 0.1 * is) << sentence;
    }
}

TEST(FloatRounding, NamesTheMoveOfAMap) {
  EXPECT_EQ(said({{684766.42, 5403215.17, 243.1}, {684992.57, 5403514.2, 280}}),
            "x, y and z are stored as float32, which rounds them by at most 0.25; transform(translate=[-685000, "
            "-5403000, 0]) before would round them by at most 3.1e-05.");
  EXPECT_EQ(said({{1, 2, 3}, {4, 5, 6}}), "x, y and z are stored as float32, which rounds them by at most 2.4e-07.");
}

TEST(FloatRounding, IsOfNarrowedCoordinatesAlone) {
  const std::vector<Vec3> points = {{684766.42, 5403215.17, 243.1}};
  EXPECT_EQ(said(points, Type::f32), "");
  EXPECT_NE(said(points, Type::i32), "");
  FloatRounding moved(positions_of(Type::f32), {position_attribute()}, positions_of(Type::f32));
  moved.see(as_floats(points));
  EXPECT_NE(moved.sentence(), "");
  FloatRounding wide(positions_of(Type::i32), {}, positions_of(Type::f64));
  EXPECT_EQ(wide.sentence(), "");
}

TEST(FloatRounding, OfNoPointsNoFiniteOnesAndZerosIsNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(said({}), "");
  EXPECT_EQ(said({{nan, 1e9, 2}, {1, INFINITY, 2}}), "");
  EXPECT_EQ(said({{0, 0, 0}, {0, 0, 0}}), "");
  EXPECT_NE(said({{5403215, 5403215, 5403215}}).find("translate=[-5403215, -5403215, -5403215]"), std::string::npos);
}

}  // namespace
}  // namespace pointsweep
