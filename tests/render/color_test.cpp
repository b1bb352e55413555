// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "pointsweep/error.h"
#include "pointsweep/render/color_map.h"
#include "pointsweep/render/point_color.h"

namespace pointsweep {
namespace {

TEST(ColorMap, RunsFromVioletToYellowAndGetsLighterAllTheWay) {
  EXPECT_EQ(viridis(0), (Rgb{68, 1, 84}));
  EXPECT_EQ(viridis(1), (Rgb{253, 231, 37}));
  EXPECT_EQ(viridis(-5), viridis(0));
  EXPECT_EQ(viridis(7), viridis(1));
  const auto lightness = [](Rgb c) { return 0.2126 * c.red + 0.7152 * c.green + 0.0722 * c.blue; };
  for (int i = 0; i < 100; ++i)
    EXPECT_LT(lightness(viridis(i / 100.0)), lightness(viridis((i + 1) / 100.0)) + 0.3) << i;
  EXPECT_EQ(viridis(std::nan("")), (Rgb{128, 128, 128}));
}

TEST(ColorMap, RangesLeaveOutliersAside) {
  std::vector<double> values;
  for (int i = 0; i <= 1000; ++i) values.push_back(i);
  values.insert(values.end(), {1e30, -1e30, std::nan(""), INFINITY});
  const auto [lo, hi] = robust_range(values);
  EXPECT_NEAR(lo, 50, 2);
  EXPECT_NEAR(hi, 950, 2);
  EXPECT_EQ(robust_range({std::nan("")}), std::pair(0.0, 1.0));
}

/// Fields of one type, and records to look at.
struct Records {
  explicit Records(std::vector<std::string> names, Type type) {
    for (const auto& name : names) schema.append(name, type);
    record.resize(schema.stride);
  }
  const std::byte* operator()(std::vector<double> values) {
    for (std::size_t i = 0; i < values.size(); ++i) set_value(schema.fields[i], record.data(), values[i]);
    return record.data();
  }
  Schema schema;
  std::vector<std::byte> record;
};

TEST(PointColor, ColorsAreOutOf255Or65535Or1AsTheirValuesShow) {
  Records bytes({"red", "green", "blue"}, Type::u8), words({"r", "g", "b"}, Type::u16),
      floats({"Red", "Green", "Blue"}, Type::f32);
  PointColor of_bytes(bytes.schema, "", 2), of_words(words.schema, "rgb", 2), of_floats(floats.schema, "rgb", 2);
  of_bytes.look_at(bytes({10, 20, 30}));
  EXPECT_EQ(of_bytes(bytes({10, 20, 30})), (Rgb{10, 20, 30}));
  of_words.look_at(words({200, 100, 0}));
  EXPECT_EQ(of_words(words({200, 100, 0})), (Rgb{200, 100, 0}));
  of_words.look_at(words({65535, 256, 0}));
  EXPECT_EQ(of_words(words({65535, 257 * 30, 0})), (Rgb{255, 30, 0}));
  of_floats.look_at(floats({0.5, 1, 0}));
  EXPECT_EQ(of_floats(floats({0.2, 1, 0})), (Rgb{51, 255, 0}));
}

TEST(PointColor, CurvatureIsTheBestThereIs) {
  Records made({"x", "k1", "rms_curvature"}, Type::f32), scanned({"x", "surface_variation"}, Type::f32);
  EXPECT_EQ(PointColor(made.schema, "curvature", 2).name(), "rms_curvature");
  EXPECT_EQ(PointColor(scanned.schema, "curvature", 2).name(), "surface_variation");
  EXPECT_EQ(PointColor(made.schema, "k1", 2).name(), "k1");
}

TEST(PointColor, NumbersBecomePlacesBetweenTheEndsOfTheRange) {
  Records r({"x", "y", "z", "age"}, Type::f64);
  PointColor age(r.schema, "AGE", 2), height(r.schema, "height", 1);
  age.set_range(10, 20);
  EXPECT_EQ(age(r({0, 0, 0, 10})), viridis(0));
  EXPECT_EQ(age(r({0, 0, 0, 15})), viridis(0.5));
  EXPECT_EQ(age(r({0, 0, 0, 99})), viridis(1));
  EXPECT_EQ(height.number(r({1, 2, 3, 4})), 2);
  age.set_range(3, 3);
  EXPECT_EQ(age(r({0, 0, 0, 3})), viridis(0));
}

TEST(PointColor, WithoutAWordItIsColorsThenGreyWithNormalsThenHeight) {
  Records all({"x", "y", "z", "nx", "ny", "nz", "red", "green", "blue"}, Type::f32),
      normals({"x", "y", "z", "nx", "ny", "nz"}, Type::f32), bare({"x", "y", "z"}, Type::f32);
  EXPECT_EQ(PointColor(all.schema, "", 2).name(), "rgb");
  EXPECT_EQ(PointColor(normals.schema, "", 2).name(), "plain");
  EXPECT_EQ(PointColor(bare.schema, "", 2).name(), "height");
  PointColor by_normal(normals.schema, "normal", 2);
  EXPECT_EQ(by_normal(normals({0, 0, 0, 1, -1, 0})), (Rgb{255, 0, 128}));
}

TEST(PointColor, SaysWhatThereIsWhereTheNameIsUnknown) {
  Records bare({"x", "y", "z"}, Type::f32);
  for (const char* what : {"rgb", "normal", "curvature", "age"}) {
    try {
      PointColor(bare.schema, what, 2);
      ADD_FAILURE() << what;
    } catch (const UsageError& error) {
      EXPECT_NE(std::string(error.what()).find("it has x, y, z"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace pointsweep
