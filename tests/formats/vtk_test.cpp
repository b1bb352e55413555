// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <string>
#include <vector>

#include "pointsweep/error.h"
#include "pointsweep/formats/registry.h"
#include "tests/formats/point_files.h"
#include "tests/formats/temporary_folder.h"
#include "tests/support/data_folder.h"

namespace pointsweep {
namespace {

using testing::HasSubstr;
using Numbers = std::vector<double>;

/// Returns the bytes of a number, big-endian.
template <class T>
std::string big(T value) {
  std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
  return {bytes.rbegin(), bytes.rend()};
}
template <class T>
std::string bigs(std::initializer_list<T> values) {
  std::string bytes;
  for (const T value : values) bytes += big(value);
  return bytes;
}

const std::string kText = "# vtk DataFile Version 3.0\nby hand\nASCII\n",
                  kBinary = "# vtk DataFile Version 4.2\nby hand\nBINARY\n";

class Vtk : public testing::Test {
 protected:
  std::unique_ptr<Reader> opened(const std::string& text) {
    return open_reader(folder_.write(fmt::format("points{}", ++files_), text));
  }
  std::string refusal(const std::string& text) {
    return sentence_of<Error>([&] { values_of(*opened(text), "x"); });
  }
  /// Expects the attributes of a file, which are equal in both encodings.
  static void expect_all_attributes(Reader& reader) {
    EXPECT_EQ(values_of(reader, "x"), (Numbers{1.5, 4}));
    EXPECT_EQ(values_of(reader, "y"), (Numbers{2, 5}));
    EXPECT_EQ(values_of(reader, "z"), (Numbers{3, -6}));
    EXPECT_EQ(values_of(reader, "reflectance"), (Numbers{-7, 300}));
    EXPECT_EQ(values_of(reader, "nz"), (Numbers{1, 0.5}));
    EXPECT_EQ(values_of(reader, "red"), (Numbers{255, 0}));
    EXPECT_EQ(values_of(reader, "alpha"), (Numbers{51, 255}));
    EXPECT_EQ(values_of(reader, "time of flight"), (Numbers{0.25, 1e300}));
    const Schema& schema = reader.info().schema;
    const Field& flow = schema.fields[*schema.find("flow")];
    EXPECT_EQ(flow.count, 3u);
    EXPECT_EQ(flow.type, Type::f32);
    const auto records = all_records(reader);
    EXPECT_EQ(value_of(flow, records.data() + schema.stride, 2), 6);
    ASSERT_EQ(reader.info().warnings.size(), 2u);
    EXPECT_THAT(reader.info().warnings[0], HasSubstr("its 1 cells are left out"));
    EXPECT_THAT(reader.info().warnings[1], HasSubstr("odd of its points left out"));
  }
  const TemporaryFolder folder_;
  int files_ = 0;
};

TEST_F(Vtk, TextGivesPointsWithAllTheirAttributes) {
  const auto reader =
      opened(kText +
             "DATASET POLYDATA\nFIELD FieldData 1\nTIME 1 1 double\n12.5\nPOINTS 2 float\n1.5 2 3 4\n5 -6\nVERTICES 2 "
             "4\n1 0\n1 1\n"
             "LINES 1 3\n2 0 1\nCELL_DATA 3\nSCALARS cell int 1\nLOOKUP_TABLE default\n1 2\n3\nPOINT_DATA 2\n"
             "SCALARS reflectance short\nLOOKUP_TABLE default\n-7 300\nNORMALS normals float\n0 0 1 0 0 .5\n"
             "COLOR_SCALARS tint 4\n1.0 0.5 0 0.2 0 0 0 1\nVECTORS flow float\n1 2 3 4 5 6\n"
             "FIELD more 2\ntime%20of%20flight 1 2 double\n0.25 1e300\nMETADATA\nINFORMATION 1\nNAME L2 LOCATION "
             "vtk\nDATA 2 0 1\n\n"
             "odd 1 3 int\n1 2 3\n");
  EXPECT_EQ(reader->info().format, "VTK legacy POLYDATA ascii");
  expect_all_attributes(*reader);
}

TEST_F(Vtk, BinaryGivesPointsWithAllTheirAttributes) {
  const auto reader = opened(
      kBinary + "DATASET POLYDATA\nPOINTS 2 float\n" + bigs<float>({1.5f, 2, 3, 4, 5, -6}) + "\nVERTICES 2 4\n" +
      bigs<std::int32_t>({1, 0, 1, 1}) + "\nLINES 1 3\n" + bigs<std::int32_t>({2, 0, 1}) +
      "\nCELL_DATA 3\nCOLOR_SCALARS c 3\n" + std::string(9, '\n') + "\nPOINT_DATA 2\nSCALARS reflectance short 1\n" +
      "LOOKUP_TABLE mine\n" + bigs<std::int16_t>({-7, 300}) + "\nLOOKUP_TABLE mine 2\n" + std::string(8, 'L') +
      "\nNORMALS normals double\n" + bigs<double>({0, 0, 1, 0, 0, 0.5}) + "\nCOLOR_SCALARS tint 4\n" +
      std::string("\xff\x80\x00\x33\x00\x00\x00\xff", 8) + "\nVECTORS flow float\n" + bigs<float>({1, 2, 3, 4, 5, 6}) +
      "\nFIELD more 2\ntime%20of%20flight 1 2 double\n" + bigs<double>({0.25, 1e300}) + "\nodd 1 2 bit\n" + "\xc0" +
      "\n");
  EXPECT_EQ(reader->info().format, "VTK legacy POLYDATA binary");
  expect_all_attributes(*reader);
}

TEST_F(Vtk, GridsAndCellsOfVersionFiveAreRead) {
  const auto grid = opened(kText + "DATASET STRUCTURED_GRID\nDIMENSIONS 2 1 1\nPOINTS 2 double\n1 2 3 4 5 6\n");
  EXPECT_EQ(values_of(*grid, "z"), (Numbers{3, 6}));
  const auto cells = opened(
      "# vtk DataFile Version 5.1\nvtk output\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 3 double\n" +
      bigs<double>({1, 2, 3, 4, 5, 6, 7, 8, 9}) + "\nCELLS 2 3\nOFFSETS vtktypeint64\n" + bigs<std::int64_t>({0, 3}) +
      "\nCONNECTIVITY vtktypeint64\n" + bigs<std::int64_t>({0, 1, 2}) + "\nCELL_TYPES 1\n" + bigs<std::int32_t>({5}) +
      "\nPOINT_DATA 3\nSCALARS id vtktypeint64 1\nLOOKUP_TABLE default\n" + bigs<std::int64_t>({10, 20, 1LL << 40}) +
      "\n");
  EXPECT_EQ(values_of(*cells, "x"), (Numbers{1, 4, 7}));
  EXPECT_EQ(values_of(*cells, "id"), (Numbers{10, 20, std::ldexp(1.0, 40)}));
  ASSERT_EQ(cells->info().warnings.size(), 1u);
  EXPECT_THAT(cells->info().warnings[0], HasSubstr("its 1 cells"));
}

TEST_F(Vtk, NamesThatAreTakenGetANumber) {
  const auto reader = opened(kText +
                             "DATASET POLYDATA\nPOINTS 1 float\n1 2 3\nPOINT_DATA 1\nSCALARS X float\nLOOKUP_TABLE "
                             "default\n9\nSCALARS x_2 float\nLOOKUP_TABLE default\n8\n"
                             "FIELD f 1\nx 1 1 float\n7\n");
  EXPECT_EQ(field_names(reader->info().schema), (std::vector<std::string>{"x", "y", "z", "X_2", "x_2_2", "x_3"}));
  EXPECT_EQ(values_of(*reader, "x"), Numbers{1});
}

TEST_F(Vtk, AreReadInAnyOrder) {
  std::string text = kText + "DATASET POLYDATA\nPOINTS 50000 float\n",
              bytes = kBinary + "DATASET POLYDATA\nPOINTS 50000 float\n", tail;
  for (int i = 0; i < 50000; ++i) {
    text += fmt::format("{} {} 0{}", i, -i, i % 3 == 2 ? "\n" : " ");
    bytes += bigs<float>({static_cast<float>(i), static_cast<float>(-i), 0});
  }
  text += "\nPOINT_DATA 50000\nSCALARS s int 2\nLOOKUP_TABLE default\n";
  bytes += "\nPOINT_DATA 50000\nSCALARS s int 2\nLOOKUP_TABLE default\n";
  for (int i = 0; i < 50000; ++i) {
    text += fmt::format("{} {}\n", i, 2 * i);
    bytes += bigs<std::int32_t>({i, 2 * i});
  }
  for (const std::string& file : {text, bytes}) {
    const auto reader = opened(file);
    const Schema& schema = reader->info().schema;
    std::vector<std::byte> record(schema.stride);
    for (const std::uint64_t row : {49999, 5, 16384, 16383, 40000, 40001, 0}) {
      ASSERT_EQ(reader->read(row, record), 1u);
      EXPECT_EQ(value_of(schema.fields[1], record.data()), -static_cast<double>(row));
      EXPECT_EQ(value_of(schema.fields[3], record.data(), 1), 2 * static_cast<double>(row));
    }
    EXPECT_EQ(reader->read(50000, record), 0u);
  }
}

TEST_F(Vtk, WrongFilesAreOneSentence) {
  const std::string points = "DATASET POLYDATA\nPOINTS 2 float\n1 2 3 4 5 6\n";
  EXPECT_THAT(refusal("# vtk DataFile Version 3.0\n\nTEXT\n"), HasSubstr("should be ASCII or BINARY"));
  EXPECT_THAT(refusal(kText), HasSubstr("has no POINTS"));
  EXPECT_THAT(refusal(kText + "DATASET STRUCTURED_POINTS\nDIMENSIONS 9 9 9\n"),
              HasSubstr("of the kind STRUCTURED_POINTS"));
  EXPECT_THAT(refusal(kText + "DATASET POLYDATA\nPOINTS many float\n"), HasSubstr("a whole number is missing, 'many'"));
  EXPECT_THAT(refusal(kText + "DATASET POLYDATA\nPOINTS 3 float\n1 2 3 4 5 6 7 8\n"),
              HasSubstr("'position' should have 3 rows, but the file ends after 2"));
  EXPECT_THAT(refusal(kText + "DATASET POLYDATA\nPOINTS 99999999999999999 float\n1 2 3\n"), HasSubstr("ends after 1"));
  EXPECT_THAT(refusal(kBinary + "DATASET POLYDATA\nPOINTS 9999999999999999999 float\n" + std::string(24, 'a')),
              HasSubstr("but the file ends after 0"));
  EXPECT_THAT(refusal(kBinary + "DATASET POLYDATA\nPOINTS 3 float\n" + std::string(30, 'a')),
              HasSubstr("should have 3 rows, but the file ends after 2"));
  EXPECT_THAT(refusal(kText + "DATASET POLYDATA\nPOINTS 2 bit\n0 1 0 1 0 1\n"),
              HasSubstr("type that coordinates cannot have"));
  EXPECT_THAT(refusal(kText + points + "POINT_DATA 3\n"), HasSubstr("POINT_DATA are for 3 points, and there are 2"));
  EXPECT_THAT(refusal(kText + points + "POINT_DATA 2\nFIELD f 1\na 999999999 2 int\n"),
              HasSubstr("999999999 components"));
  EXPECT_THAT(refusal(kText + points + "POINT_DATA 2\nFIELD f 9999999999\na 1 2 int\n1 2\n"), HasSubstr("are missing"));
  EXPECT_THAT(refusal(kText + points + "POINT_DATA 2\nFIELD f 1\na 1 2 string\nb\nc\n"),
              HasSubstr("of the type 'STRING'"));
  EXPECT_THAT(refusal(kText + points + "POINT_DATA 2\nSHADES a int\n1 2\n"), HasSubstr("'SHADES' is no keyword"));
  EXPECT_THAT(refusal(kText + points + "POINT_DATA 2\nSCALARS a int\n1 2\n"), HasSubstr("LOOKUP_TABLE is missing"));
  EXPECT_THAT(refusal(kText + points + "LINES 99999999999999 99999999999999\n"), HasSubstr("'LINES' should have"));
  EXPECT_THAT(refusal(kText + points + points), HasSubstr("a second time"));
  EXPECT_THAT(refusal(kText + "DATASET POLYDATA\nPOINTS 1 float\n1 2 three\n"),
              HasSubstr("'three' in 'position' is no float32"));
  EXPECT_THAT(refusal(kText + "DATASET POLYDATA\nPOINTS 1 float\n1 2 " + std::string(20000, '3')),
              HasSubstr("longer than"));
  EXPECT_EQ(opened(kText + "DATASET POLYDATA\nPOINTS 0 float\n")->info().count, 0u);
}

TEST_F(Vtk, TruncatedBinaryFilesAreRefused) {
  const std::string whole = kBinary + "DATASET POLYDATA\nPOINTS 2 float\n" + bigs<float>({1, 2, 3, 4, 5, 6}) +
                            "\nPOINT_DATA 2\nSCALARS reflectance short 1\nLOOKUP_TABLE default\n" +
                            bigs<std::int16_t>({-7, 300});
  values_of(*opened(whole), "x");
  for (std::size_t bytes = kBinary.size(); bytes < whole.size(); ++bytes) {
    // A file that ends between an array and the next keyword lacks nothing that it has announced.
    const std::string part = whole.substr(0, bytes);
    const std::size_t end = whole.find("\nPOINT_DATA");
    if (bytes == end || bytes == end + 1 || part.ends_with("POINT_DATA 2") || part.ends_with("POINT_DATA 2\n"))
      continue;
    EXPECT_THROW(values_of(*opened(part), "x"), Error) << bytes;
  }
}

TEST(VtkData, HasTheValuesOfTheFile) {
  const std::filesystem::path scans = data_folder() / "scans/libpointmatcher";
  if (!std::filesystem::exists(scans)) GTEST_SKIP() << "no real data in " << data_folder();
  const auto vtk = open_reader(scans / "cloud.00000.vtk"), csv = open_reader(scans / "car_cloud400.csv");
  EXPECT_EQ(vtk->info().count, 24989u);
  EXPECT_EQ(csv->info().count, 24989u);
  std::ifstream file(scans / "cloud.00000.vtk");
  std::string line;
  for (int i = 0; i < 5; ++i) std::getline(file, line);
  const Numbers x = values_of(*vtk, "x"), z = values_of(*vtk, "z");
  for (std::size_t i = 0; i < x.size(); ++i) {
    float a = 0, b = 0, c = 0;
    file >> a >> b >> c;
    ASSERT_EQ(x[i], a) << i;
    ASSERT_EQ(z[i], c) << i;
  }
}

}  // namespace
}  // namespace pointsweep
