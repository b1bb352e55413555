// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "pointsweep/error.h"
#include "pointsweep/formats/e57/e57_format.h"
#include "pointsweep/formats/format.h"
#include "tests/formats/e57_test_file.h"
#include "tests/formats/temporary_folder.h"
#include "tests/support/data_folder.h"

namespace pointsweep {
namespace {

using e57_test::integers;
using e57_test::reals;
using e57_test::Scan;
using e57_test::singles;

class E57 : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_codecs()) GTEST_SKIP() << "built without codecs";
  }

  std::unique_ptr<Reader> opened(const std::string& bytes) {
    std::ofstream(folder_ / "a.e57", std::ios::binary) << bytes;
    return open_e57(folder_ / "a.e57");
  }

  static std::vector<std::byte> all_of(Reader& reader) {
    std::vector<std::byte> records(reader.info().count * reader.info().schema.stride);
    EXPECT_EQ(reader.read(0, records), reader.info().count);
    return records;
  }

  static std::vector<double> column(Reader& reader, std::string_view name) {
    const Schema& schema = reader.info().schema;
    const std::vector<std::byte> records = all_of(reader);
    std::vector<double> values;
    for (std::size_t i = 0; i < reader.info().count; ++i)
      values.push_back(value_of(schema.fields.at(schema.find(name).value()), records.data() + i * schema.stride));
    return values;
  }

  const TemporaryFolder folder_;
};

Scan three_points() {
  return {
      .points = 3,
      .attributes = {reals("cartesianX", {1, 2, 3}), reals("cartesianY", {0, 0.5, -7}), reals("cartesianZ", {9, 8, 7})},
      .pose = ""};
}

using Numbers = std::vector<double>;

TEST_F(E57, GivesAttributesOfEveryKindUnderTheNamesOfTheLibrary) {
  Scan scan = three_points();
  scan.attributes.push_back(singles("intensity", {0.25f, 0.5f, 1}));
  for (const char* color : {"colorRed", "colorGreen", "colorBlue"})
    scan.attributes.push_back(integers(color, 0, 255, 8, {1, 128, 255}));
  scan.attributes.push_back(integers("rowIndex", -5, 2, 3, {0, 5, 7}));
  scan.attributes.push_back(integers("timeStamp", 0, 1000, 10, {0, 3, 1000}, " scale=\"0.5\" offset=\"100\""));
  scan.attributes.push_back(integers("pointSourceId", 7, 7, 0, {0, 0, 0}));
  const auto reader = opened(e57_test::file({scan}));
  EXPECT_EQ(reader->info().count, 3u);
  EXPECT_EQ(reader->info().format, "E57, 1 scan");
  EXPECT_EQ(column(*reader, "x"), (Numbers{1, 2, 3}));
  EXPECT_EQ(column(*reader, "y"), (Numbers{0, 0.5, -7}));
  EXPECT_EQ(column(*reader, "z"), (Numbers{9, 8, 7}));
  EXPECT_EQ(column(*reader, "intensity"), (Numbers{0.25, 0.5, 1}));
  EXPECT_EQ(column(*reader, "green"), (Numbers{1, 128, 255}));
  EXPECT_EQ(column(*reader, "row"), (Numbers{-5, 0, 2}));
  EXPECT_EQ(column(*reader, "time_stamp"), (Numbers{100, 101.5, 600}));
  EXPECT_EQ(column(*reader, "pointSourceId"), (Numbers{7, 7, 7}));
  const auto type = [&](const char* name) {
    return reader->info().schema.fields[reader->info().schema.find(name).value()].type;
  };
  EXPECT_EQ(type("x"), Type::f64);
  EXPECT_EQ(type("intensity"), Type::f32);
  EXPECT_EQ(type("red"), Type::u8);
  EXPECT_EQ(type("row"), Type::i8);
  EXPECT_EQ(type("time_stamp"), Type::f64);
}

TEST_F(E57, AppliesThePoseToCoordinatesAndNormals) {
  Scan scan = three_points();
  scan.attributes.push_back(singles("nor:normalX", {1, 0, 0}));
  scan.attributes.push_back(singles("nor:normalY", {0, 1, 0}));
  scan.attributes.push_back(singles("nor:normalZ", {0, 0, 1}));
  const double half = std::numbers::pi / 4;  // a quarter turn about z
  scan.pose = e57_test::pose(std::to_string(std::cos(half)), std::to_string(std::sin(half)), "10");
  const auto reader = opened(e57_test::file({scan}));
  const Numbers x = column(*reader, "x"), y = column(*reader, "y"), z = column(*reader, "z");
  const Numbers nx = column(*reader, "nx"), ny = column(*reader, "ny"), nz = column(*reader, "nz");
  const Numbers want_x{10, 9.5, 17}, want_y{1, 2, 3}, want_nx{0, -1, 0}, want_ny{1, 0, 0};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(x[i], want_x[i], 1e-5);
    EXPECT_NEAR(y[i], want_y[i], 1e-5);
    EXPECT_NEAR(nx[i], want_nx[i], 1e-5);
    EXPECT_NEAR(ny[i], want_ny[i], 1e-5);
    EXPECT_NEAR(nz[i], i == 2 ? 1 : 0, 1e-5);
  }
  EXPECT_NEAR(z[0], 9, 1e-5);
}

TEST_F(E57, MakesCartesianCoordinatesOfSphericalOnesAndNanOfInvalidOnes) {
  const double turn = std::numbers::pi / 2;
  const Scan scan{
      .points = 3,
      .attributes = {reals("sphericalRange", {2, 2, 5}), reals("sphericalAzimuth", {turn, 0, 0}),
                     reals("sphericalElevation", {0, turn, 0}), integers("sphericalInvalidState", 0, 2, 2, {0, 0, 2})},
      .pose = ""};
  const auto reader = opened(e57_test::file({scan}));
  const Numbers x = column(*reader, "x"), y = column(*reader, "y"), z = column(*reader, "z");
  EXPECT_NEAR(x[0], 0, 1e-12);
  EXPECT_NEAR(y[0], 2, 1e-12);
  EXPECT_NEAR(z[0], 0, 1e-12);
  EXPECT_NEAR(x[1], 0, 1e-12);
  EXPECT_NEAR(z[1], 2, 1e-12);
  EXPECT_TRUE(std::isnan(x[2]) && std::isnan(y[2]) && std::isnan(z[2]));
  EXPECT_EQ(column(*reader, "spherical_invalid_state"), (Numbers{0, 0, 2}));
}

TEST_F(E57, IsOneCloudOfAllScansWithTheUnionOfTheirAttributes) {
  Scan first = three_points(), second = three_points(),
       empty{.points = 0, .attributes = {reals("cartesianX", {})}, .pose = ""};
  first.attributes.push_back(integers("intensity", 0, 200, 8, {5, 6, 7}));
  second.attributes.push_back(integers("intensity", 0, 1000, 10, {900, 0, 3}));
  second.attributes.push_back(singles("extra", {1.5f, 2.5f, 3.5f}));
  const auto reader = opened(e57_test::file({first, empty, second}));
  EXPECT_EQ(reader->info().count, 6u);
  EXPECT_EQ(column(*reader, "scan"), (Numbers{0, 0, 0, 2, 2, 2}));
  EXPECT_EQ(column(*reader, "intensity"), (Numbers{5, 6, 7, 900, 0, 3}));
  EXPECT_EQ(column(*reader, "extra"), (Numbers{0, 0, 0, 1.5, 2.5, 3.5}));
}

TEST_F(E57, GivesAnyRowsInAnyOrder) {
  const auto reader = opened(e57_test::file({three_points(), three_points(), three_points()}));
  const std::vector<std::byte> all = all_of(*reader);
  const std::size_t stride = reader->info().schema.stride;
  std::mt19937 random(2);
  for (int i = 0; i < 100; ++i) {
    const std::uint64_t row = random() % 10;
    std::vector<std::byte> records((1 + random() % 6) * stride);
    const std::size_t rows = reader->read(row, records);
    ASSERT_EQ(rows, row < 9 ? std::min<std::size_t>(records.size() / stride, 9 - row) : 0);
    ASSERT_TRUE(std::equal(records.begin(), records.begin() + static_cast<std::ptrdiff_t>(rows * stride),
                           all.begin() + static_cast<std::ptrdiff_t>(row * stride)));
  }
}

TEST_F(E57, ImagesAreLeftOutWithAWarningThatNamesTheFile) {
  const std::string image = "<vectorChild type=\"Structure\"><guid type=\"String\">{i}</guid></vectorChild>";
  const auto reader = opened(e57_test::file({three_points()}, "", image));
  ASSERT_EQ(reader->info().warnings.size(), 1u);
  EXPECT_EQ(reader->info().warnings[0], reader->info().path.string() + ": its 1 image is left out.");
}

TEST_F(E57, KeepsTheCoordinateReferenceSystem) {
  const auto reader = opened(
      e57_test::file({three_points()}, "GEOGCS[&quot;WGS 84&quot;,AUTHORITY[&quot;EPSG&quot;,&quot;4326&quot;]]"));
  ASSERT_TRUE(reader->info().crs.has_value());
  EXPECT_EQ(reader->info().crs->epsg, 4326);
}

TEST_F(E57, DamagedFilesAreOneSentence) {
  const std::string good = e57_test::file({three_points()});
  Scan many = three_points();
  many.points = 1'000'000'000'000;
  Scan constant{.points = 9,
                .attributes = {integers("cartesianX", 1, 1, 0, {}), integers("cartesianY", 1, 1, 0, {}),
                               integers("cartesianZ", 1, 1, 0, {})},
                .pose = ""};
  Scan flat = three_points();
  flat.attributes.pop_back();
  std::string flipped = good, huge = good;
  flipped[60] = static_cast<char>(flipped[60] ^ 1);
  huge[39] = 0x7f;  // high byte of the length of the XML section
  const std::pair<std::string, const char*> cases[] = {
      {e57_test::file({many}), "more than fit into the file"},
      {e57_test::file({constant}), "no attribute with more than one value"},
      {e57_test::file({flat}), "scan 1 has neither Cartesian nor spherical coordinates"},
      {flipped, "checksum"},
      {huge, "larger than the file"},
      {good.substr(0, 20), "end too early"},
  };
  for (const auto& [bytes, words] : cases) {
    const std::string sentence = sentence_of<Error>([&, &b = bytes] { all_of(*opened(b)); });
    EXPECT_NE(sentence.find(words), std::string::npos) << "expected: " << words << "\ngot: " << sentence;
    EXPECT_NE(sentence.find("a.e57: "), std::string::npos) << sentence;
  }
}

TEST_F(E57, TruncatedAndDamagedFilesAreErrorsNotCrashes) {
  const std::string good = e57_test::file({three_points(), three_points()});
  std::mt19937 random(4);
  for (int i = 0; i < 150; ++i) {
    std::string bytes = good;
    if (i % 2 == 0) {
      bytes.resize(random() % bytes.size());
    } else {
      for (int n = 0; n < 3; ++n) bytes[random() % bytes.size()] = static_cast<char>(random());
    }
    EXPECT_THROW(all_of(*opened(bytes)), Error) << i;
  }
}

/// The expected counts and bounds were read with pye57.
TEST(E57Data, HasThePointsOfTheInventory) {
  const std::filesystem::path scans = data_folder() / "scans";
  if (!std::filesystem::exists(scans)) GTEST_SKIP() << "no real data in " << data_folder();
  if (!has_codecs()) GTEST_SKIP() << "built without codecs";
  const std::pair<const char*, std::uint64_t> files[] = {
      {"libE57Format/reference/bunnyDouble.e57", 30571},
      {"libE57Format/self/ColouredCubeDouble.e57", 7680},
      {"libE57Format/self/ColouredCubeFloat.e57", 7680},
      {"libE57Format/3rdParty/las2e57/ColourRepresentation.e57", 153},
      {"libE57Format/self/PinholeImageWithDistortionParameters.e57", 0},
      {"pdal/e57/A4.e57", 4},
      {"pdal/e57/A_B.e57", 6},
      {"pdal/e57/A_B_different_dims.e57", 2},
      {"pdal/e57/A_moved_B.e57", 6},
      {"pye57/testWithNormals.e57", 2},
      {"pye57/translationWithoutRotation.e57", 4}};
  for (const auto& [file, points] : files) {
    SCOPED_TRACE(file);
    const auto reader = open_e57(scans / file);
    EXPECT_EQ(reader->info().count, points);
    std::vector<std::byte> records(points * reader->info().schema.stride);
    EXPECT_EQ(reader->read(0, records), points);
  }
}

}  // namespace
}  // namespace pointsweep
