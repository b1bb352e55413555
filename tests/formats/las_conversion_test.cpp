// SPDX-License-Identifier: MIT
/// Clouds that are not LAS, or not of one LAS layout, written as LAS.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include "pointsweep/error.h"
#include "pointsweep/formats/las/las_format.h"
#include "pointsweep/formats/las/las_layout.h"
#include "pointsweep/formats/las/las_reader.h"
#include "tests/formats/las_test_file.h"
#include "tests/formats/temporary_folder.h"

namespace pointsweep {
namespace {

constexpr std::size_t kCount = 1000;

/// A cloud of random values, whose schema a test may extend.
struct TestCloud {
  Schema schema;
  std::vector<std::byte> records;
  Box bounds;

  explicit TestCloud(Type coordinates) {
    for (const char* name : {"x", "y", "z"}) schema.append(name, coordinates);
  }
  void fill(double half_extent, Vec3 center) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> unit(-1, 1);
    records.resize(kCount * schema.stride);
    for (std::size_t i = 0; i < kCount; ++i) {
      for (std::size_t f = 0; f < schema.fields.size(); ++f) {
        const double value =
            f < 3 ? center[static_cast<int>(f)] + half_extent * unit(random) : 100 * unit(random) + 100;
        for (std::uint32_t c = 0; c < schema.fields[f].count; ++c) set_value(schema.fields[f], record(i), value + c, c);
      }
      bounds.include(Vec3{at("x", i), at("y", i), at("z", i)});
    }
  }
  std::byte* record(std::size_t i) { return records.data() + i * schema.stride; }
  double at(const char* name, std::size_t i, std::uint32_t component = 0) {
    return value_of(schema.fields[*schema.find(name)], record(i), component);
  }
  OutputPlan plan(const std::filesystem::path& path) const {
    OutputPlan p;
    p.path = path;
    p.schema = schema;
    p.count = kCount;
    p.bounds = bounds;
    return p;
  }
};

struct Written {
  FileInfo info;
  std::vector<std::byte> records;
  double at(const char* name, std::size_t i) const {
    return value_of(info.schema.fields.at(info.schema.find(name).value()), records.data() + i * info.schema.stride);
  }
};

Written write_and_read(const OutputPlan& plan, const std::vector<std::byte>& records) {
  const auto writer = create_las_writer(plan);
  writer->write(records);
  writer->finish();
  const auto reader = open_las(plan.path);
  Written written{reader->info(), std::vector<std::byte>(reader->info().count * reader->info().schema.stride)};
  reader->read(0, written.records);
  return written;
}

TEST(LasConversion, CoordinatesLoseLessThanTheStepsOfFloat32) {
  const TemporaryFolder folder;
  for (const Type type : {Type::f32, Type::f64}) {
    TestCloud cloud(type);
    cloud.fill(800, {5'000'000, 650'000, 300});
    const Written out = write_and_read(cloud.plan(folder / (type == Type::f32 ? "a.las" : "b.las")), cloud.records);
    EXPECT_EQ(out.info.format, "LAS 1.4 point format 6");
    EXPECT_EQ(out.info.count, kCount);
    EXPECT_TRUE(out.info.warnings.empty());
    for (std::size_t i = 0; i < kCount; ++i) {
      for (const char* name : {"x", "y", "z"}) {
        ASSERT_NEAR(out.at(name, i), cloud.at(name, i), 1.3e-9 * 1600 + 1e-9);
        if (type == Type::f32 && *name != 'z') {  // z comes close to 0, where float32 is finer than any integer
          ASSERT_EQ(static_cast<float>(out.at(name, i)), static_cast<float>(cloud.at(name, i)));
        }
      }
      ASSERT_EQ(out.at("return_number", i), 1);
      ASSERT_EQ(out.at("number_of_returns", i), 1);
    }
  }
}

TEST(LasConversion, ThePointFormatFollowsTheAttributes) {
  const TemporaryFolder folder;
  const auto format_with = [&](std::initializer_list<const char*> names) {
    TestCloud cloud(Type::f64);
    for (const char* name : names) cloud.schema.append(name, Type::u16);
    cloud.fill(1, {});
    std::filesystem::remove(folder / "a.las");
    return write_and_read(cloud.plan(folder / "a.las"), cloud.records).info.format;
  };
  EXPECT_EQ(format_with({"intensity"}), "LAS 1.4 point format 6");
  EXPECT_EQ(format_with({"red", "green"}), "LAS 1.4 point format 6");
  EXPECT_EQ(format_with({"red", "green", "blue"}), "LAS 1.4 point format 7");
  EXPECT_EQ(format_with({"red", "green", "blue", "nir"}), "LAS 1.4 point format 8");
}

TEST(LasConversion, EveryAttributeArrivesInItsFieldOrAsExtraBytes) {
  const TemporaryFolder folder;
  TestCloud cloud(Type::f64);
  for (const char* name : {"red", "green", "blue", "classification"}) cloud.schema.append(name, Type::u8);
  cloud.schema.append("GpsTime", Type::f64);
  cloud.schema.append("nx", Type::f32);
  cloud.schema.append("label", Type::i32);
  cloud.schema.append("pair", Type::f32, 2);
  cloud.fill(10, {1, 2, 3});
  const Written out = write_and_read(cloud.plan(folder / "a.las"), cloud.records);
  EXPECT_EQ(out.info.schema.stride, 36u + 4 + 4 + 8);
  for (std::size_t i = 0; i < kCount; ++i) {
    for (const char* name : {"classification", "gps_time", "nx", "label"})
      ASSERT_EQ(out.at(name, i), cloud.at(name, i)) << name;
    for (const char* name : {"red", "green", "blue"})
      ASSERT_EQ(out.at(name, i), 257 * cloud.at(name, i)) << name << " of 8 bits gets 16";
    ASSERT_EQ(out.at("pair[1]", i), cloud.at("pair", i, 1));
  }
}

TEST(LasConversion, SaysHowANameIsCutAndRefusesTwoThatWouldBeOne) {
  const TemporaryFolder folder;
  const std::string same(32, 'a');
  TestCloud cloud(Type::f64);
  cloud.schema.append(same + "_one", Type::f32);
  cloud.schema.append(std::string(31, 'b') + "é", Type::u8);
  cloud.schema.append("c", Type::u8, 2);
  cloud.fill(10, {});
  const OutputPlan plan = cloud.plan(folder / "a.las");
  const auto warnings = create_las_writer(plan)->warnings();
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_NE(warnings[0].find("'" + same + "_one' is written as '" + same + "'"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[1].find("is written as '" + std::string(31, 'b') + "'"), std::string::npos) << warnings[1];
  const Written out = write_and_read(plan, cloud.records);
  EXPECT_EQ(out.at(same.c_str(), 7), cloud.at((same + "_one").c_str(), 7));
  for (const std::string& other : {same, same + "_two", "A" + same}) {
    OutputPlan two = cloud.plan(folder / "b.las");
    two.schema.append(other, Type::f32);
    EXPECT_THROW(create_las_writer(two), UsageError) << other;
  }
}

TEST(LasConversion, ValuesThatALasFieldWouldRoundAreAlsoStoredExactly) {
  const TemporaryFolder folder;
  TestCloud cloud(Type::f64);
  cloud.schema.append("intensity", Type::f32);
  cloud.schema.append("user_data", Type::i32);
  cloud.fill(10, {});
  const Written out = write_and_read(cloud.plan(folder / "a.las"), cloud.records);
  for (std::size_t i = 0; i < kCount; ++i) {
    ASSERT_EQ(out.at("intensity", i), std::nearbyint(cloud.at("intensity", i)));
    ASSERT_EQ(out.at("intensity_float32", i), cloud.at("intensity", i));
    ASSERT_EQ(out.at("user_data_int32", i), cloud.at("user_data", i));
  }
}

TEST(LasConversion, IntegerCoordinatesKeepTheirScaleAndNeedNoBounds) {
  const TemporaryFolder folder;
  TestCloud cloud(Type::i32);
  for (Field& field : cloud.schema.fields) field.scale = 0.37;
  cloud.schema.fields[1].bias = 1e6;
  cloud.fill(1000, {0, 1e6, 0});
  OutputPlan plan = cloud.plan(folder / "a.las");
  plan.bounds.reset();
  const Written out = write_and_read(plan, cloud.records);
  for (std::size_t i = 0; i < kCount; ++i) {
    for (const char* name : {"x", "y", "z"}) ASSERT_EQ(out.at(name, i), cloud.at(name, i));
  }
}

TEST(LasConversion, RefusesRealCoordinatesWithoutBounds) {
  const TemporaryFolder folder;
  TestCloud cloud(Type::f64);
  OutputPlan plan = cloud.plan(folder / "a.las");
  plan.bounds.reset();
  EXPECT_NE(sentence_of<Error>([&] { create_las_writer(plan); }).find("needs their bounds"), std::string::npos);
}

TEST(LasConversion, RefusesCoordinatesThatLasCannotHoldAndLeavesNothing) {
  const TemporaryFolder folder;
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const auto& [bad, sentence] : {std::pair{nan, "y of row 777 is nan, which LAS cannot hold"},
                                      {-inf, "y of row 777 is -inf"},
                                      {1e12, "y of row 777 is 1000000000000, too far"}}) {
    TestCloud cloud(Type::f64);
    cloud.fill(10, {});
    set_value(cloud.schema.fields[1], cloud.record(777), bad);
    const auto writer = create_las_writer(cloud.plan(folder / "a.las"));
    const std::string error = sentence_of<Error>([&] { writer->write(cloud.records); });
    EXPECT_NE(error.find(sentence), std::string::npos) << error;
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(LasConversion, OfAnotherLasLayoutKeepsHeaderVlrsAndWhatLiesBehind) {
  const TemporaryFolder folder;
  las_test::File file;
  file.format = 3;
  file.extra_bytes = 1;
  file.vlrs = {las_test::vlr("LASF_Projection", 34735, "crs"),
               las_test::vlr("LASF_Spec", 4, las_test::descriptor("old", 1))};
  const std::string in = file.bytes() + "tail";
  const auto reader = open_las(folder.write("in.las", in));
  TestCloud cloud(Type::f64);  // float64, as after a merge with a cloud of another format
  cloud.schema.append("old", Type::u8);
  cloud.fill(1000, {500000, 0, 0});
  OutputPlan plan = cloud.plan(folder / "out.las");
  plan.extras = reader->info().extras;
  const Written out = write_and_read(plan, cloud.records);
  const std::string bytes = contents(folder / "out.las");
  EXPECT_EQ(out.info.format, "LAS 1.4 point format 6");
  EXPECT_EQ(bytes.substr(8, 16), in.substr(8, 16));  // project GUID
  EXPECT_EQ(bytes.substr(375, 57), file.vlrs[0]);
  EXPECT_EQ(las_test::get<std::uint32_t>(bytes, 100), 2u);
  EXPECT_EQ(bytes.substr(bytes.size() - 4), "tail");
  EXPECT_EQ(out.info.schema.fields.back().name, "old");
  for (std::size_t i = 0; i < kCount; ++i) ASSERT_EQ(out.at("old", i), cloud.at("old", i));
}

TEST(LasConversion, MoreThan32BitsOfPointsMakeAnOldFileLas14) {
  const TemporaryFolder folder;
  las_test::File file;
  file.vlrs = {las_test::vlr("me", 1, "abc")};
  const auto reader = open_las(folder.write("in.las", file.bytes() + "waveforms"));
  OutputPlan plan;
  plan.path = folder / "out.las";
  plan.schema = reader->info().schema;
  plan.extras = reader->info().extras;
  plan.count = 5'000'000'000;
  const LasLayout layout = lay_out_las(plan);
  EXPECT_EQ(layout.header.minor, 4);
  EXPECT_EQ(layout.header.header_size, 375);
  EXPECT_EQ(layout.header.offset_to_points, 375u + 57);
  EXPECT_EQ(layout.points_end(plan.count), 432 + 100'000'000'000u);
  ASSERT_EQ(layout.tail.size(), 1u);
  EXPECT_EQ(layout.tail[0].size(), 9u);
}

TEST(LasConversion, AnEmptyCloudIsAValidFile) {
  const TemporaryFolder folder;
  TestCloud cloud(Type::f64);
  OutputPlan plan = cloud.plan(folder / "a.las");
  plan.count = 0;
  plan.bounds.reset();
  EXPECT_EQ(write_and_read(plan, {}).info.count, 0u);
}

TEST(LasConversion, EqualRunsGiveEqualBytes) {
  const TemporaryFolder folder;
  TestCloud cloud(Type::f32);
  cloud.fill(1, {});
  write_and_read(cloud.plan(folder / "a.las"), cloud.records);
  OutputPlan plan = cloud.plan(folder / "b.las");
  const auto writer = create_las_writer(plan);
  const auto part = std::span(cloud.records);
  writer->write_at(500, part.subspan(500 * cloud.schema.stride));
  writer->write_at(0, part.first(500 * cloud.schema.stride));
  writer->finish();
  EXPECT_TRUE(contents(folder / "a.las") == contents(folder / "b.las"));
}

}  // namespace
}  // namespace pointsweep
