// SPDX-License-Identifier: MIT
/// Writing E57 files: schemas that no real file has, and values that must be refused. tests/readers compares written
/// files with what libE57Format reads.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <set>
#include <string>

#include "pointsweep/error.h"
#include "pointsweep/formats/crs.h"
#include "pointsweep/formats/e57/e57_format.h"
#include "pointsweep/formats/format.h"
#include "pointsweep/formats/provenance.h"
#include "tests/formats/point_files.h"
#include "tests/formats/temporary_folder.h"

namespace pointsweep {
namespace {

class E57Writing : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_codecs()) GTEST_SKIP() << "built without codecs";
  }

  OutputPlan plan(std::uint64_t count) const {
    OutputPlan plan = plan_for(folder_ / "out.e57", count);
    plan.overwrite = true;
    for (const char* axis : {"x", "y", "z"}) plan.schema.append(axis, Type::f64);
    return plan;
  }
  std::unique_ptr<Reader> written(const OutputPlan& plan, const std::vector<std::byte>& records) const {
    write_all(plan, records);
    return open_reader(plan.path);
  }
  /// Writes a file with the coordinates and one attribute, `values`, and returns the values of that attribute as a
  /// reader gets them.
  std::vector<double> written_values(const Field& field, const std::vector<double>& values) const {
    OutputPlan one = plan(values.size());
    const std::size_t at = one.schema.append(field.name, field.type);
    one.schema.fields[at] = field;
    one.schema.fields[at].offset = 24;
    std::vector<std::byte> records(values.size() * one.schema.stride);
    for (std::size_t i = 0; i < values.size(); ++i)
      set_value(one.schema.fields[at], records.data() + i * one.schema.stride, values[i]);
    return values_of(*written(one, records), field.name);
  }

  const TemporaryFolder folder_;
};

using Numbers = std::vector<double>;

TEST_F(E57Writing, KeepsTheEndsOfEveryType) {
  const auto ends = [&]<class T>(T, Type type) {
    const Numbers values{static_cast<double>(std::numeric_limits<T>::lowest()), 0, 1,
                         static_cast<double>(std::numeric_limits<T>::max())};
    EXPECT_EQ(written_values({.name = "value", .type = type}, values), values) << name_of(type);
    const auto reader = open_reader(folder_ / "out.e57");
    EXPECT_EQ(reader->info().schema.fields[*reader->info().schema.find("value")].type, type);
  };
  ends(std::int8_t{}, Type::i8), ends(std::uint8_t{}, Type::u8), ends(std::int16_t{}, Type::i16);
  ends(std::uint16_t{}, Type::u16), ends(std::int32_t{}, Type::i32), ends(std::uint32_t{}, Type::u32);
  ends(float{}, Type::f32), ends(double{}, Type::f64);
  const Numbers wide{-0x1p63, -0x1p40, 0, 0x1p62};
  EXPECT_EQ(written_values({.name = "value", .type = Type::i64}, wide), wide);
  const Numbers huge{0, 0x1p62};
  EXPECT_EQ(written_values({.name = "value", .type = Type::u64}, huge), huge);
}

TEST_F(E57Writing, RefusesAnIntegerThatE57CannotHoldAndLeavesNothing) {
  EXPECT_THROW(written_values({.name = "value", .type = Type::u64}, {1, 0x1p63}), Error);
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST_F(E57Writing, KeepsPartsOfAWordAndScaledIntegers) {
  const Field part{.name = "value", .type = Type::u8, .bit_shift = 3, .bit_width = 4};
  EXPECT_EQ(written_values(part, {0, 15, 7}), (Numbers{0, 15, 7}));
  const Field scaled{.name = "value", .type = Type::i16, .scale = 0.25, .bias = 100};
  EXPECT_EQ(written_values(scaled, {100, 99.75, 0x1p15 / 4 + 99.75, 100 - 0x1p15 / 4}),
            (Numbers{100, 99.75, 0x1p15 / 4 + 99.75, 100 - 0x1p15 / 4}));
}

TEST_F(E57Writing, PointsThatAreNotFiniteAreInvalidAndAllOthersKeepTheirBits) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1e6, 1e6);
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
  for (const std::size_t count : {0, 1, 3000, 20'000}) {
    std::vector<double> xyz(3 * count);
    for (double& v : xyz) v = uniform(random);
    for (std::size_t i = 0; i < count; i += 1 + random() % 7) xyz[3 * i + random() % 3] = i % 2 ? nan : infinite;
    const auto bytes = std::as_bytes(std::span(xyz));
    const auto reader = written(plan(count), {bytes.begin(), bytes.end()});
    ASSERT_EQ(reader->info().count, count);
    const Numbers x = values_of(*reader, "x"), y = values_of(*reader, "y"), z = values_of(*reader, "z");
    const Numbers state = values_of(*reader, "invalid_state");
    for (std::size_t i = 0; i < count; ++i) {
      const bool finite = std::isfinite(xyz[3 * i]) && std::isfinite(xyz[3 * i + 1]) && std::isfinite(xyz[3 * i + 2]);
      ASSERT_EQ(state[i], finite ? 0 : 2);
      ASSERT_TRUE(finite ? x[i] == xyz[3 * i] && y[i] == xyz[3 * i + 1] && z[i] == xyz[3 * i + 2]
                         : std::isnan(x[i]) && std::isnan(y[i]) && std::isnan(z[i]));
    }
  }
}

TEST_F(E57Writing, NamesAttributesAsTheStandardDoesWhereItHasThem) {
  Schema schema;
  for (const char* name : {"intensity", "nx", "ny", "nz", "red", "green", "z", "y", "x", "row", "roughness"})
    schema.append(name, Type::f32);
  schema.append("column", Type::u16);
  std::vector<std::string> names;
  for (const E57Column& column : e57_columns(schema)) names.push_back(column.attribute.name);
  EXPECT_EQ(names, (std::vector<std::string>{"cartesianZ", "cartesianY", "cartesianX", "intensity", "nor:normalX",
                                             "nor:normalY", "nor:normalZ", "ps:red", "ps:green", "ps:row",
                                             "ps:roughness", "columnIndex"}))
      << "two of three colours, and a row that is no integer, are no attributes of the standard";
}

TEST_F(E57Writing, MakesNamesThatXmlAllows) {
  EXPECT_EQ(e57_name("a b/c"), "a_b_c");
  EXPECT_EQ(e57_name("9lives"), "_9lives");
  EXPECT_EQ(e57_name("XmlThing"), "_XmlThing");
  EXPECT_EQ(e57_name("cartesianX"), "_cartesianX");
  EXPECT_EQ(e57_name("größe"), "gr____e");
  OutputPlan all = plan(1);
  for (const char* name : {"a+b", "a_b", "cartesianX", "9", "rowIndex", "scan"}) all.schema.append(name, Type::u8);
  all.schema.append("list", Type::u8, 3);
  std::set<std::string> stored;
  for (const E57Column& column : e57_columns(all.schema)) stored.insert(column.attribute.name);
  EXPECT_TRUE(stored.contains("ps:a_b") && stored.contains("ps:a_b_2")) << "a file that has one name twice is none";
  const auto reader = written(all, std::vector<std::byte>(all.schema.stride, std::byte{7}));
  EXPECT_EQ(field_names(reader->info().schema),
            (std::vector<std::string>{"x", "y", "z", "invalid_state", "a_b", "a_b_2", "_cartesianX", "_9", "_rowIndex",
                                      "scan", "list_0", "list_1", "list_2"}));
  for (const char* name : {"a_b", "a_b_2", "_cartesianX", "_9", "_rowIndex", "scan", "list_0", "list_2"})
    EXPECT_EQ(values_of(*reader, name), Numbers{7}) << name;
}

TEST_F(E57Writing, SaysHowItWasMadeAndTheSameRunGivesTheSameBytes) {
  OutputPlan one = plan(1);
  one.provenance = lines_of({.version = "1", .stages = {"where(x < 3 && y > 2)"}, .settings = {}, .inputs = {}});
  const std::vector<std::byte> record(one.schema.stride);
  EXPECT_EQ(written(one, record)->info().provenance, one.provenance);
  OutputPlan again = one;
  again.path = folder_ / "again.e57";
  write_all(again, record);
  EXPECT_EQ(contents(one.path), contents(again.path));
  again.provenance.clear();
  write_all(again, record);
  EXPECT_NE(contents(one.path), contents(again.path)) << "and another identifier";
}

TEST_F(E57Writing, WarnsOfACoordinateSystemThatItCannotState) {
  OutputPlan one = plan(1);
  one.crs = crs_of_geotiff({{1, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, 26910}, {}, ""});
  const auto writer = create_writer(one);
  ASSERT_EQ(writer->warnings().size(), 1u);
  EXPECT_NE(writer->warnings().front().find("EPSG:26910"), std::string::npos) << writer->warnings().front();
}

TEST_F(E57Writing, CountsPointsThatLoseFiniteCoordinates) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Numbers xyz{1, 2, 3, 4, 5, nan, nan, nan, nan, nan, 8, 9};
  const auto writer = create_writer(plan(4));
  writer->write(std::as_bytes(std::span(xyz)));
  writer->finish();
  ASSERT_EQ(writer->warnings().size(), 1u);
  EXPECT_NE(writer->warnings().front().find("2 points"), std::string::npos) << writer->warnings().front();
}

TEST_F(E57Writing, AnUnfinishedFileLeavesNothing) {
  OutputPlan many = plan(100'000);
  {
    const auto writer = create_writer(many);
    writer->write(std::vector<std::byte>(50'000 * many.schema.stride));
    EXPECT_THROW(writer->finish(), Error) << "points are missing";
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

}  // namespace
}  // namespace pointsweep
