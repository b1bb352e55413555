// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "pointsweep/colors/color_map.h"
#include "pointsweep/error.h"
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

/// Fields of one type, and records of them.
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

/// Passes all records to `color`, settles it and returns it. Positions are x, y, z of the records if they have these
/// fields.
PointColor settled(PointColor color, const Schema& schema, const std::vector<std::vector<double>>& rows, Up up = {},
                   bool flat = false) {
  std::vector<Vec3> positions;
  std::vector<std::byte> records(rows.size() * schema.stride);
  for (std::size_t row = 0; row < rows.size(); ++row) {
    std::byte* record = &records[row * schema.stride];
    for (std::size_t i = 0; i < std::min(rows[row].size(), schema.fields.size()); ++i)
      set_value(schema.fields[i], record, rows[row][i]);
    color.look_at(record);
    positions.push_back(rows[row].size() < 3 ? Vec3{} : Vec3{rows[row][0], rows[row][1], rows[row][2]});
  }
  color.settle({positions, records, schema.stride}, up, flat);
  return color;
}

TEST(PointColor, ColorsAreOutOf255Or65535Or1AsTheirValuesShow) {
  Records bytes({"red", "green", "blue"}, Type::u8), words({"r", "g", "b"}, Type::u16),
      floats({"Red", "Green", "Blue"}, Type::f32);
  EXPECT_EQ(settled(PointColor(bytes.schema, ""), bytes.schema, {{10, 20, 30}, {0, 0, 0}})(bytes({10, 20, 30}), {}),
            (Rgb{10, 20, 30}));
  EXPECT_EQ(settled(PointColor(words.schema, "rgb"), words.schema, {{200, 100, 0}})(words({200, 100, 0}), {}),
            (Rgb{200, 100, 0}));
  EXPECT_EQ(settled(PointColor(words.schema, "rgb"), words.schema, {{65535, 256, 0}})(words({65535, 257 * 30, 0}), {}),
            (Rgb{255, 30, 0}));
  EXPECT_EQ(settled(PointColor(floats.schema, "rgb"), floats.schema, {{0.5, 1, 0}})(floats({0.2, 1, 0}), {}),
            (Rgb{51, 255, 0}));
}

TEST(PointColor, CurvatureIsTheBestThereIs) {
  Records made({"x", "k1", "rms_curvature"}, Type::f32), scanned({"x", "surface_variation"}, Type::f32);
  EXPECT_EQ(PointColor(made.schema, "curvature").name(), "rms_curvature");
  EXPECT_EQ(PointColor(scanned.schema, "curvature").name(), "surface_variation");
  EXPECT_EQ(PointColor(made.schema, "k1").name(), "k1");
}

TEST(PointColor, NumbersBecomePlacesBetweenTheEndsOfTheRange) {
  Records r({"x", "y", "z", "age"}, Type::f64);
  const PointColor age = settled(PointColor(r.schema, "AGE"), r.schema, {{0, 0, 0, 10}, {0, 0, 0, 20}, {0, 0, 0, 20}});
  EXPECT_EQ(age.lo(), 10);
  EXPECT_EQ(age.hi(), 20);
  EXPECT_EQ(age(r({0, 0, 0, 10}), {}), viridis(0));
  EXPECT_EQ(age(r({0, 0, 0, 15}), {}), viridis(0.5));
  EXPECT_EQ(age(r({0, 0, 0, 99}), {}), viridis(1));
  const PointColor same = settled(PointColor(r.schema, "age"), r.schema, {{0, 0, 0, 3}});
  EXPECT_EQ(same(r({0, 0, 0, 3}), {}), viridis(0));
}

TEST(PointColor, HeightIsTheCoordinateThatPointsUp) {
  Records r({"x", "y", "z"}, Type::f64);
  const std::vector<std::vector<double>> rows = {{1, 2, 3}, {1, 7, 3}, {1, 7, 3}};
  const PointColor up = settled(PointColor(r.schema, "height"), r.schema, rows, {1, 1});
  EXPECT_EQ(up.number(r({1, 2, 3}), {1, 2, 3}), 2);
  EXPECT_EQ(up.hi(), 7);
  const PointColor down = settled(PointColor(r.schema, "height"), r.schema, rows, {1, -1});
  EXPECT_EQ(down.number(r({1, 2, 3}), {1, 2, 3}), -2);
}

TEST(PointColor, WithoutAWordItIsColorsThenGreyWithNormalsThenHeight) {
  Records all({"x", "y", "z", "red", "green", "blue", "nx", "ny", "nz"}, Type::f32),
      normals({"x", "y", "z", "nx", "ny", "nz"}, Type::f32), bare({"x", "y", "z"}, Type::f32);
  const auto chosen = [](const Records& r, bool flat) {
    return settled(PointColor(r.schema, ""), r.schema, {{1, 2, 3, 4, 5, 6}, {1, 2, 3, 4, 9, 6}}, {}, flat).name();
  };
  EXPECT_EQ(chosen(all, false), "rgb");
  EXPECT_EQ(chosen(all, true), "rgb");
  EXPECT_EQ(chosen(normals, false), "plain");
  EXPECT_EQ(chosen(normals, true), "height") << "shaded by the normals";
  EXPECT_EQ(chosen(bare, false), "height");
  Records n({"nx", "ny", "nz"}, Type::f32);
  EXPECT_EQ(settled(PointColor(n.schema, "normal"), n.schema, {})(n({1, -1, 0}), {}), (Rgb{255, 0, 128}));
}

TEST(PointColor, ColorsThatAreAllTheSameAreNotChosen) {
  Records r({"x", "y", "z", "red", "green", "blue"}, Type::u16);
  for (const double value : {0.0, 255.0, 65535.0}) {
    const std::vector<std::vector<double>> rows = {{1, 2, 3, value, value, value}, {4, 5, 6, value, value, value}};
    const PointColor chosen = settled(PointColor(r.schema, ""), r.schema, rows);
    EXPECT_EQ(chosen.name(), "height") << value;
    EXPECT_NE(chosen.remark().find("same colour"), std::string::npos) << chosen.remark();
    const PointColor wanted = settled(PointColor(r.schema, "rgb"), r.schema, rows);
    EXPECT_EQ(wanted.name(), "rgb") << "who asks for it gets it, and the remark";
    EXPECT_NE(wanted.remark(), "");
  }
  EXPECT_EQ(settled(PointColor(r.schema, ""), r.schema, {{1, 2, 3, 0, 0, 0}, {1, 2, 3, 0, 0, 1}}).name(), "rgb");
}

TEST(PointColor, ClassesHaveTheirColorsAndAreListed) {
  Records r({"x", "y", "z", "Classification"}, Type::u8);
  const PointColor color =
      settled(PointColor(r.schema, "classification"), r.schema, {{0, 0, 0, 9}, {0, 0, 0, 2}, {0, 0, 0, 9}});
  EXPECT_TRUE(color.is_class());
  EXPECT_FALSE(color.is_number());
  EXPECT_EQ(color.classes(), (std::vector<std::uint8_t>{2, 9}));
  const Rgb ground = color(r({0, 0, 0, 2}), {}), water = color(r({0, 0, 0, 9}), {}), tree = color(r({0, 0, 0, 5}), {});
  EXPECT_GT(ground.red, ground.blue + 50) << "brown";
  EXPECT_GT(water.blue, water.red + 50) << "blue";
  EXPECT_GT(tree.green, std::max(tree.red, tree.blue) + 50) << "green";
}

TEST(PointColor, SaysWhatThereIsWhereTheNameIsUnknown) {
  Records bare({"x", "y", "z"}, Type::f32);
  for (const char* what : {"rgb", "normal", "curvature", "classification", "age"}) {
    try {
      PointColor(bare.schema, what);
      ADD_FAILURE() << what;
    } catch (const UsageError& error) {
      EXPECT_NE(std::string(error.what()).find("it has x, y, z"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace pointsweep
