// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las/las_reader.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <span>

#include "pointsweep/error.h"
#include "tests/formats/las_test_file.h"
#include "tests/formats/point_files.h"
#include "tests/formats/temporary_folder.h"

namespace pointsweep {
namespace {

using las_test::File;

/// Returns the sentence of the Error of opening `file` after `change` was applied to its bytes.
template <class Change>
std::string error_after(const File& file, Change&& change) {
  const TemporaryFolder folder;
  std::string bytes = file.bytes();
  change(bytes);
  const auto path = folder.write("a.las", bytes);
  return sentence_of<Error>([&] { open_las(path); });
}

double value(const Reader& reader, const std::string& records, const std::string& name, std::size_t row = 0) {
  const Schema& schema = reader.info().schema;
  const auto at = schema.find(name);
  EXPECT_TRUE(at) << name;
  return value_of(schema.fields[*at], reinterpret_cast<const std::byte*>(records.data()) + row * schema.stride);
}

TEST(LasReader, RecordsAreTheBytesOfTheFileInEveryPointFormat) {
  for (int format = 0; format <= 10; ++format) {
    for (const int extra : {0, 5}) {
      const TemporaryFolder folder;
      File file;
      file.minor = 4;
      file.format = format;
      file.extra_bytes = extra;
      const auto reader = open_las(folder.write("a.las", file.bytes()));
      EXPECT_EQ(reader->info().count, 100u);
      EXPECT_EQ(reader->info().schema.stride, file.record_length());
      EXPECT_EQ(record_text(*reader), file.points());
      EXPECT_EQ(reader->info().format, "LAS 1.4 point format " + std::to_string(format));
    }
  }
}

TEST(LasReader, ReadsFromAnyRowAndStopsAtTheLast) {
  const TemporaryFolder folder;
  const File file;
  const auto reader = open_las(folder.write("a.las", file.bytes()));
  std::string bytes(20 * 30 + 7, '\0');
  const auto buffer = std::as_writable_bytes(std::span(bytes));
  EXPECT_EQ(reader->read(50, buffer), 30u);
  EXPECT_EQ(bytes.substr(0, 600), file.points().substr(50 * 20, 600));
  EXPECT_EQ(reader->read(90, buffer), 10u);
  EXPECT_EQ(bytes.substr(0, 200), file.points().substr(90 * 20, 200));
  EXPECT_EQ(reader->read(100, buffer), 0u);
}

TEST(LasReader, DecodesTheCoreOfFormatsZeroToFive) {
  const TemporaryFolder folder;
  for (int format = 0; format <= 5; ++format) {
    File file;
    file.minor = 3;
    file.format = format;
    std::string bytes = file.bytes();
    const std::size_t at = file.points_at();
    las_test::put(bytes, at, std::array<std::int32_t, 3>{100, -2000, 3});
    las_test::put(bytes, at + 12, std::uint16_t{40000});
    bytes[at + 14] = static_cast<char>(0b10'101'011);
    bytes[at + 15] = static_cast<char>(0b1'0'1'10010);
    bytes[at + 16] = static_cast<char>(-15);
    bytes[at + 17] = static_cast<char>(200);
    las_test::put(bytes, at + 18, std::uint16_t{65000});
    const auto reader = open_las(folder.write("a.las", bytes));
    const std::string records = record_text(*reader);
    const auto v = [&](const char* name) { return value(*reader, records, name); };
    EXPECT_EQ(v("x"), 100 * 0.01 + 500000);
    EXPECT_EQ(v("y"), -2000 * 0.001 - 20.5);
    EXPECT_EQ(v("z"), 0.75);
    EXPECT_EQ(v("intensity"), 40000);
    EXPECT_EQ(v("return_number"), 3);
    EXPECT_EQ(v("number_of_returns"), 5);
    EXPECT_EQ(v("scan_direction_flag"), 0);
    EXPECT_EQ(v("edge_of_flight_line"), 1);
    EXPECT_EQ(v("classification"), 18);
    EXPECT_EQ(v("synthetic"), 1);
    EXPECT_EQ(v("key_point"), 0);
    EXPECT_EQ(v("withheld"), 1);
    EXPECT_EQ(v("scan_angle"), -15);
    EXPECT_EQ(v("user_data"), 200);
    EXPECT_EQ(v("point_source_id"), 65000);
    std::filesystem::remove(folder / "a.las");
  }
}

TEST(LasReader, DecodesTheCoreOfFormatsSixToTen) {
  const TemporaryFolder folder;
  for (int format = 6; format <= 10; ++format) {
    File file;
    file.minor = 4;
    file.format = format;
    std::string bytes = file.bytes();
    const std::size_t at = file.points_at();
    bytes[at + 14] = static_cast<char>(0b1101'1011);
    bytes[at + 15] = static_cast<char>(0b0'1'10'1010);
    bytes[at + 16] = static_cast<char>(255);
    bytes[at + 17] = 9;
    las_test::put(bytes, at + 18, std::int16_t{-15000});
    las_test::put(bytes, at + 20, std::uint16_t{7});
    las_test::put(bytes, at + 22, 1.25e8);
    const auto reader = open_las(folder.write("a.las", bytes));
    const std::string records = record_text(*reader);
    const auto v = [&](const char* name) { return value(*reader, records, name); };
    EXPECT_EQ(v("return_number"), 11);
    EXPECT_EQ(v("number_of_returns"), 13);
    EXPECT_EQ(v("synthetic"), 0);
    EXPECT_EQ(v("key_point"), 1);
    EXPECT_EQ(v("withheld"), 0);
    EXPECT_EQ(v("overlap"), 1);
    EXPECT_EQ(v("scanner_channel"), 2);
    EXPECT_EQ(v("scan_direction_flag"), 1);
    EXPECT_EQ(v("edge_of_flight_line"), 0);
    EXPECT_EQ(v("classification"), 255);
    EXPECT_EQ(v("user_data"), 9);
    EXPECT_DOUBLE_EQ(v("scan_angle"), -90);
    EXPECT_EQ(v("point_source_id"), 7);
    EXPECT_EQ(v("gps_time"), 1.25e8);
    std::filesystem::remove(folder / "a.las");
  }
}

TEST(LasReader, DecodesTimeColorsInfraredAndWaveformWhereTheFormatHasThem) {
  // Offsets of gps_time, red, nir and wavepacket_index in the record of a format; 0 for a field that the format lacks.
  struct Places {
    std::size_t time, red, nir, wave;
  };
  constexpr Places kPlaces[] = {{0, 0, 0, 0},    {20, 0, 0, 0},   {0, 20, 0, 0},   {20, 28, 0, 0},
                                {20, 0, 0, 28},  {20, 28, 0, 34}, {22, 0, 0, 0},   {22, 30, 0, 0},
                                {22, 30, 36, 0}, {22, 0, 0, 30},  {22, 30, 36, 38}};
  const TemporaryFolder folder;
  for (int format = 0; format <= 10; ++format) {
    const Places& places = kPlaces[format];
    File file;
    file.minor = 4;
    file.format = format;
    std::string bytes = file.bytes();
    const std::size_t at = file.points_at();
    if (places.time) las_test::put(bytes, at + places.time, -3.5);
    if (places.red) las_test::put(bytes, at + places.red, std::array<std::uint16_t, 3>{1, 2000, 65535});
    if (places.nir) las_test::put(bytes, at + places.nir, std::uint16_t{77});
    if (places.wave) {
      bytes[at + places.wave] = 5;
      las_test::put(bytes, at + places.wave + 1, std::uint64_t{1} << 40);
      las_test::put(bytes, at + places.wave + 9, std::uint32_t{256});
      las_test::put(bytes, at + places.wave + 13, std::array<float, 4>{1.5f, 2.5f, -3.5f, 4.5f});
    }
    const auto reader = open_las(folder.write("a.las", bytes));
    const std::string records = record_text(*reader);
    const auto has = [&](const char* name) { return reader->info().schema.find(name).has_value(); };
    const auto v = [&](const char* name) { return value(*reader, records, name); };
    ASSERT_EQ(has("gps_time"), places.time != 0) << format;
    ASSERT_EQ(has("red") && has("green") && has("blue"), places.red != 0) << format;
    ASSERT_EQ(has("nir"), places.nir != 0) << format;
    ASSERT_EQ(has("wavepacket_index"), places.wave != 0) << format;
    if (places.time) {
      EXPECT_EQ(v("gps_time"), -3.5);
    }
    if (places.red) {
      EXPECT_EQ(v("red") + v("green") * 10 + v("blue") * 100, 1 + 20000 + 6553500);
    }
    if (places.nir) {
      EXPECT_EQ(v("nir"), 77);
    }
    if (!places.wave) continue;
    EXPECT_EQ(v("wavepacket_index"), 5);
    EXPECT_EQ(v("wavepacket_offset"), 1099511627776.0);
    EXPECT_EQ(v("wavepacket_size"), 256);
    EXPECT_EQ(v("return_point_wave_location"), 1.5);
    EXPECT_EQ(v("x_t") + 10 * v("y_t") + 100 * v("z_t"), 2.5 - 35 + 450);
  }
}

TEST(LasReader, RefusesHeadersThatCannotBeTrue) {
  struct Case {
    const char* sentence;
    void (*change)(std::string&);
  };
  using las_test::put;
  const Case cases[] = {
      {"is empty", [](std::string& b) { b.clear(); }},
      {"no LAS file", [](std::string& b) { b[0] = 'X'; }},
      {"ends at byte 100, inside the LAS header", [](std::string& b) { b.resize(100); }},
      {"ends at byte 300, inside the LAS header", [](std::string& b) { b.resize(300); }},
      {"LAS 2.4", [](std::string& b) { b[24] = 2; }},
      {"LAS 1.5", [](std::string& b) { b[25] = 5; }},
      {"a header of 227 bytes", [](std::string& b) { put(b, 94, std::uint16_t{227}); }},
      {"inside the header of 375 bytes", [](std::string& b) { put(b, 96, std::uint32_t{300}); }},
      {"points should begin at byte 4000000000", [](std::string& b) { put(b, 96, std::uint32_t{4000000000u}); }},
      {"is compressed (byte 104), but has no LASzip VLR", [](std::string& b) { b[104] = static_cast<char>(0x80 | 7); }},
      {"is compressed (byte 104), but has no LASzip VLR", [](std::string& b) { b[104] = static_cast<char>(0x40 | 3); }},
      {"point format 11", [](std::string& b) { b[104] = 11; }},
      {"point format 63", [](std::string& b) { b[104] = 63; }},
      {"35 bytes (byte 105) is too short for point format 7", [](std::string& b) { put(b, 105, std::uint16_t{35}); }},
      {"0 bytes (byte 105)", [](std::string& b) { put(b, 105, std::uint16_t{0}); }},
      {"the scale of x is 0 (byte 131)", [](std::string& b) { put(b, 131, 0.0); }},
      {"the scale of y is -0.01 (byte 139)", [](std::string& b) { put(b, 139, -0.01); }},
      {"the scale of z is nan", [](std::string& b) { put(b, 147, std::nan("")); }},
      {"the scale of z is inf", [](std::string& b) { put(b, 147, std::numeric_limits<double>::infinity()); }},
      {"the offset of y is nan (byte 163)", [](std::string& b) { put(b, 163, std::nan("")); }},
      {"counts 101 points, but the file ends after 100", [](std::string& b) { put(b, 247, std::uint64_t{101}); }},
      {"counts 18446744073709551615 points", [](std::string& b) { put(b, 247, ~std::uint64_t{0}); }},
      {"counts 100 points, but the file ends after 99", [](std::string& b) { b.pop_back(); }},
      {"counts 100 points, but the file ends after 0", [](std::string& b) { b.resize(375); }},
  };
  File file;
  file.minor = 4;
  file.format = 7;
  for (const Case& c : cases) {
    const std::string error = error_after(file, c.change);
    EXPECT_NE(error.find(c.sentence), std::string::npos) << "expected: " << c.sentence << "\ngot: " << error;
    EXPECT_NE(error.find("a.las: "), std::string::npos) << error;
  }
}

TEST(LasReader, TakesTheCountOf64BitsAndSaysSoWhenTheLegacyCountDiffers) {
  const TemporaryFolder folder;
  File file;
  file.minor = 4;
  std::string bytes = file.bytes();
  las_test::put(bytes, 107, std::uint32_t{60});
  const auto reader = open_las(folder.write("a.las", bytes));
  EXPECT_EQ(reader->info().count, 100u);
  ASSERT_EQ(reader->info().warnings.size(), 1u);
  const std::string begin = (folder / "a.las").string() + ": the header counts 100 points with 64 bits and 60 with 32";
  EXPECT_TRUE(reader->info().warnings[0].starts_with(begin)) << reader->info().warnings[0];

  las_test::put(bytes, 247, std::uint64_t{0});
  const auto legacy = open_las(folder.write("b.las", bytes));
  EXPECT_EQ(legacy->info().count, 60u);
  EXPECT_FALSE(legacy->info().warnings.empty());
}

TEST(LasReader, WarnsOfVlrsThatRunIntoThePoints) {
  const TemporaryFolder folder;
  File file;
  file.vlrs = {las_test::vlr("LASF_Projection", 34735, "12345678")};
  std::string bytes = file.bytes();
  las_test::put(bytes, 100, std::uint32_t{4000000000u});
  const auto reader = open_las(folder.write("a.las", bytes));
  EXPECT_EQ(record_text(*reader), file.points());
  ASSERT_EQ(reader->info().warnings.size(), 1u);
  EXPECT_NE(reader->info().warnings[0].find("promises 4000000000 VLRs, but only 1 fit"), std::string::npos);
}

TEST(LasReader, WarnsOfExtendedVlrsThatRunOutOfTheFile) {
  const TemporaryFolder folder;
  File file;
  file.minor = 4;
  file.format = 6;
  file.evlrs = {las_test::vlr("me", 1, "abc", true), las_test::vlr("me", 2, "defg", true)};
  const auto good = open_las(folder.write("a.las", file.bytes()));
  EXPECT_TRUE(good->info().warnings.empty());
  const auto cut = open_las(folder.write("b.las", file.bytes().substr(0, file.bytes().size() - 1)));
  ASSERT_EQ(cut->info().warnings.size(), 1u);
  EXPECT_NE(cut->info().warnings[0].find("promises 2 extended VLRs, but only 1 fit"), std::string::npos);
}

TEST(LasReader, FindsExtraBytesInAnExtendedVlr) {
  const TemporaryFolder folder;
  File file;
  file.minor = 4;
  file.format = 6;
  file.extra_bytes = 4;
  file.evlrs = {las_test::vlr("me", 1, "abc", true),
                las_test::vlr("LASF_Spec", 4, las_test::descriptor("NormalX", 9), true)};
  const auto reader = open_las(folder.write("a.las", file.bytes()));
  const Schema& schema = reader->info().schema;
  ASSERT_TRUE(schema.find("nx"));
  EXPECT_EQ(schema.fields[*schema.find("nx")].offset, 30u);
}

TEST(LasReader, BoundsAreAHintAndAbsentWhenTheyCannotBe) {
  const TemporaryFolder folder;
  std::string bytes = File{}.bytes();
  EXPECT_TRUE(open_las(folder.write("a.las", bytes))->info().bounds);
  las_test::put(bytes, 179, std::nan(""));
  EXPECT_FALSE(open_las(folder.write("b.las", bytes))->info().bounds);
  las_test::put(bytes, 179, -1e9);
  EXPECT_FALSE(open_las(folder.write("c.las", bytes))->info().bounds);
}

TEST(LasReader, SaysSoWhenTheFileShrinksWhileItIsRead) {
  const TemporaryFolder folder;
  const auto path = folder.write("a.las", File{}.bytes());
  const auto reader = open_las(path);
  std::filesystem::resize_file(path, 1000);
  std::string bytes(2000, '\0');
  EXPECT_THROW(reader->read(0, std::as_writable_bytes(std::span(bytes))), Error);
}

TEST(LasReader, SurvivesAnyDamageToTheHeaderAndVlrs) {
  const TemporaryFolder folder;
  File file;
  file.minor = 4;
  file.format = 7;
  file.extra_bytes = 6;
  file.count = 20;
  file.vlrs = {
      las_test::vlr("LASF_Projection", 34735, std::string(40, 'k')),
      las_test::vlr("LASF_Spec", 4,
                    las_test::descriptor("Pulse width", 3) + las_test::descriptor("Amplitude", 6, 24, {0.5}, {1.0}))};
  file.evlrs = {las_test::vlr("me", 1, "abc", true)};
  const std::string good = file.bytes();
  std::mt19937 random(20260718);
  int opened = 0, refused = 0;
  for (int round = 0; round < 4000; ++round) {
    std::string bytes = good;
    const unsigned flips = 1 + random() % 4;
    for (unsigned i = 0; i < flips; ++i) {
      const std::size_t region = random() % 3 == 0 ? bytes.size() : file.points_at();
      bytes[random() % region] = static_cast<char>(random() % 3 == 0 ? 0xFF : random());
    }
    if (random() % 8 == 0) bytes.resize(random() % bytes.size());
    std::filesystem::remove(folder / "a.las");
    const auto path = folder.write("a.las", bytes);
    try {
      const auto reader = open_las(path);
      ASSERT_LE(reader->info().count * reader->info().schema.stride, bytes.size());
      for (const Field& field : reader->info().schema.fields) {
        ASSERT_LE(field.offset + size_of(field.type) * field.count, reader->info().schema.stride);
      }
      record_text(*reader);
      ++opened;
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(opened, 500);
  EXPECT_GT(refused, 500);
}

}  // namespace
}  // namespace pointsweep
