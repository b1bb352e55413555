// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>

#include "pointsweep/error.h"
#include "pointsweep/formats/pcd/pcd_format.h"
#include "tests/formats/point_files.h"
#include "tests/formats/temporary_folder.h"

namespace pointsweep {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

/// Returns records of `schema`. `rows`: the values of each row, field by field, component by component.
std::vector<std::byte> records_of_rows(const Schema& schema, const std::vector<std::vector<double>>& rows) {
  std::vector<std::byte> records(rows.size() * schema.stride);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::size_t next = 0;
    for (const Field& field : schema.fields)
      for (std::uint32_t c = 0; c < field.count; ++c)
        set_value(field, records.data() + i * schema.stride, rows[i][next++], c);
  }
  return records;
}

std::string written(const OutputPlan& plan, const std::vector<std::vector<double>>& rows) {
  write_all(plan, records_of_rows(plan.schema, rows));
  return contents(plan.path);
}

Schema xyz_and(std::initializer_list<std::pair<const char*, Type>> more) {
  Schema schema;
  for (const char* axis : {"x", "y", "z"}) schema.append(axis, Type::f32);
  for (const auto& [name, type] : more) schema.append(name, type);
  return schema;
}

TEST(PcdWriter, WritesTheHeaderAndBytesOfTheFormat) {
  const TemporaryFolder folder;
  Schema schema = xyz_and({{"nx", Type::f32}, {"intensity", Type::u16}});
  schema.append("histogram", Type::i16, 3);
  const std::string file = written(plan_for(folder / "a.pcd", 2, schema),
                                   {{1, 2, 3, .5, 7, 1, 2, 3}, {4, 5, std::nan(""), 1, 65535, -1, 0, 9}});
  const std::string header =
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n"
      "FIELDS x y z normal_x intensity histogram\nSIZE 4 4 4 4 2 2\nTYPE F F F F U I\nCOUNT 1 1 1 1 1 3\n"
      "WIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA binary\n";
  ASSERT_THAT(file, StartsWith(header));
  struct Point {
    float x, y, z, nx;
    std::uint16_t intensity;
    std::int16_t histogram[3];
  } points[2];
  ASSERT_EQ(file.size(), header.size() + sizeof points);
  std::memcpy(points, file.data() + header.size(), sizeof points);
  EXPECT_EQ(points[0].nx, 0.5f);
  EXPECT_EQ(points[0].histogram[2], 3);
  EXPECT_TRUE(std::isnan(points[1].z));
  EXPECT_EQ(points[1].intensity, 65535);
  EXPECT_EQ(points[1].histogram[0], -1);
}

TEST(PcdWriter, PacksColorsOfBytesAsPclHasThem) {
  const TemporaryFolder folder;
  // The colours are neither in the order of the packed word nor side by side.
  const Schema rgb = xyz_and({{"blue", Type::u8}, {"time", Type::f64}, {"red", Type::u8}, {"green", Type::u8}});
  const std::string plain = written(plan_for(folder / "rgb.pcd", 1, rgb), {{1, 2, 3, 0x33, 9.5, 0x11, 0x22}});
  EXPECT_THAT(plain, HasSubstr("FIELDS x y z rgb time\nSIZE 4 4 4 4 8\nTYPE F F F F F\nCOUNT 1 1 1 1 1\n"));
  EXPECT_EQ(plain.substr(plain.size() - 12, 4), std::string("\x33\x22\x11\0", 4));
  const Schema rgba = xyz_and({{"red", Type::u8}, {"green", Type::u8}, {"blue", Type::u8}, {"alpha", Type::u8}});
  const std::string alpha = written(plan_for(folder / "rgba.pcd", 1, rgba), {{1, 2, 3, 0x11, 0x22, 0x33, 0x44}});
  EXPECT_THAT(alpha, HasSubstr("FIELDS x y z rgba\nSIZE 4 4 4 4\nTYPE F F F U\n"));
  EXPECT_EQ(alpha.substr(alpha.size() - 4), "\x33\x22\x11\x44");
  const auto reader = open_reader(folder / "rgba.pcd");
  EXPECT_EQ(values_of(*reader, "red"), std::vector<double>{0x11});
  EXPECT_EQ(values_of(*reader, "alpha"), std::vector<double>{0x44});
}

TEST(PcdWriter, KeepsColorsThatAreWiderOrIncomplete) {
  const TemporaryFolder folder;
  const Schema wide = xyz_and({{"red", Type::u16}, {"green", Type::u16}, {"blue", Type::u16}});
  EXPECT_THAT(written(plan_for(folder / "wide.pcd", 1, wide), {{1, 2, 3, 65535, 256, 1}}),
              HasSubstr("FIELDS x y z red green blue\nSIZE 4 4 4 2 2 2\nTYPE F F F U U U\n"));
  EXPECT_EQ(values_of(*open_reader(folder / "wide.pcd"), "green"), std::vector<double>{256});
  const Schema two = xyz_and({{"red", Type::u8}, {"green", Type::u8}});
  EXPECT_THAT(written(plan_for(folder / "two.pcd", 1, two), {{1, 2, 3, 4, 5}}), HasSubstr("FIELDS x y z red green\n"));
}

TEST(PcdWriter, StoresScaledValuesAsDoublesAndPartsOfWordsAsIntegers) {
  const TemporaryFolder folder;
  Schema schema;
  for (const char* axis : {"x", "y", "z"}) {
    schema.append(axis, Type::i32);
    schema.fields.back().scale = 0.01;
    schema.fields.back().bias = 1000;
  }
  schema.fields.push_back(
      {.name = "return_number", .type = Type::u16, .offset = schema.stride, .bit_shift = 0, .bit_width = 3});
  schema.fields.push_back(
      {.name = "returns", .type = Type::u16, .offset = schema.stride, .bit_shift = 3, .bit_width = 12});
  schema.stride += 2;
  EXPECT_THAT(written(plan_for(folder / "a.pcd", 1, schema), {{1000.01, 999, 1234.56, 5, 4095}}),
              HasSubstr("FIELDS x y z return_number returns\nSIZE 8 8 8 1 2\nTYPE F F F U U\n"));
  const auto reader = open_reader(folder / "a.pcd");
  EXPECT_EQ(values_of(*reader, "x"), std::vector<double>{1 * 0.01 + 1000});
  EXPECT_EQ(values_of(*reader, "return_number"), std::vector<double>{5});
  EXPECT_EQ(values_of(*reader, "returns"), std::vector<double>{4095});
}

/// Readers give fields named `rgb`, `rgba` and `_` a special meaning.
TEST(PcdWriter, NamesThatMeanSomethingElseInPcdGetTheirType) {
  const TemporaryFolder folder;
  const Schema schema = xyz_and({{"rgb", Type::f32},
                                 {"_", Type::u8},
                                 {"two words", Type::u8},
                                 {"red", Type::u8},
                                 {"green", Type::u8},
                                 {"blue", Type::u8}});
  written(plan_for(folder / "a.pcd", 1, schema), {{1, 2, 3, 4.5, 5, 6, 7, 8, 9}});
  const auto reader = open_reader(folder / "a.pcd");
  EXPECT_THAT(field_names(reader->info().schema),
              ElementsAre("x", "y", "z", "rgb_float32", "__uint8", "two_words", "red", "green", "blue"));
  EXPECT_EQ(values_of(*reader, "rgb_float32"), std::vector<double>{4.5});
  EXPECT_EQ(values_of(*reader, "blue"), std::vector<double>{9});
}

TEST(PcdWriter, KeepsTheViewpointOfItsInputs) {
  const TemporaryFolder folder;
  const auto file = [&](const char* name, const std::string& viewpoint) {
    folder.write(name, "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\n" + viewpoint + "DATA ascii\n1 2 3\n");
    return open_reader(folder / name)->info().extras;
  };
  const auto view = file("a.pcd", "VIEWPOINT 1 2 3 0.5 0.5 0.5 0.5\n"),
             other = file("b.pcd", "VIEWPOINT 1 2 3 1 0 0 0\n"), damaged = file("c.pcd", "VIEWPOINT 1 2 3 # 1\n"),
             none = file("d.pcd", "");
  const auto header = [&](const auto& first, std::vector<std::shared_ptr<const FormatExtras>> more) {
    OutputPlan plan = plan_for(folder / "out.pcd", 1, xyz_and({}));
    plan.overwrite = true;
    plan.extras = first;
    plan.other_extras = std::move(more);
    return written(plan, {{1, 2, 3}});
  };
  EXPECT_THAT(header(view, {}), HasSubstr("\nVIEWPOINT 1 2 3 0.5 0.5 0.5 0.5\nPOINTS 1\n"));
  EXPECT_THAT(header(view, {view}), HasSubstr("\nVIEWPOINT 1 2 3 0.5 0.5 0.5 0.5\nPOINTS 1\n"));
  EXPECT_THAT(header(view, {other}), HasSubstr("\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 1\n"));
  EXPECT_THAT(header(view, {nullptr}), HasSubstr("\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 1\n"));
  EXPECT_THAT(header(damaged, {}), HasSubstr("\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 1\n"));
  EXPECT_THAT(header(none, {}), HasSubstr("\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 1\n"));
}

TEST(PcdWriter, AHeaderWithALongHistoryIsReadAgain) {
  const TemporaryFolder folder;
  OutputPlan plan = plan_for(folder / "a.pcd", 1, xyz_and({}));
  for (int i = 0; i < 12000; ++i) plan.provenance.push_back("pointsweep stage normals");
  written(plan, {{1, 2, 3}});
  EXPECT_EQ(open_reader(folder / "a.pcd")->info().provenance, plan.provenance);
}

TEST(PcdWriter, ZeroPointsAndAWrongNumberOfPoints) {
  const TemporaryFolder folder;
  written(plan_for(folder / "none.pcd", 0, xyz_and({})), {});
  EXPECT_EQ(open_reader(folder / "none.pcd")->info().count, 0u);
  EXPECT_THROW(written(plan_for(folder / "few.pcd", 2, xyz_and({})), {{1, 2, 3}}), Error);
  EXPECT_FALSE(std::filesystem::exists(folder / "few.pcd"));
}

}  // namespace
}  // namespace pointsweep
