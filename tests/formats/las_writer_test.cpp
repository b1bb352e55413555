// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <random>
#include <span>
#include <vector>

#include "pointsweep/error.h"
#include "pointsweep/formats/las/las_format.h"
#include "pointsweep/formats/las/las_reader.h"
#include "tests/formats/las_test_file.h"
#include "tests/formats/point_files.h"
#include "tests/formats/temporary_folder.h"

namespace pointsweep {
namespace {

using las_test::descriptor;
using las_test::File;
using las_test::get;
using las_test::put;
using las_test::vlr;

OutputPlan plan_like(const Reader& reader, const std::filesystem::path& path) {
  OutputPlan plan;
  plan.path = path;
  plan.schema = reader.info().schema;
  plan.count = reader.info().count;
  plan.extras = reader.info().extras;
  return plan;
}

/// Returns the bytes that are written when `file` is read and written unchanged.
std::string copy_of(const TemporaryFolder& folder, const std::string& file) {
  const auto reader = open_las(folder.write("in.las", file));
  OutputPlan plan = plan_like(*reader, folder / "out.las");
  plan.overwrite = true;
  const auto writer = create_las_writer(plan);
  writer->write(text_bytes(record_text(*reader)));
  writer->finish();
  return contents(folder / "out.las");
}

/// Returns records with `made` random bytes after each.
std::string with_made(const std::string& records, std::size_t stride, std::size_t made) {
  std::string all;
  const std::string values = las_test::random_bytes(records.size() / stride * made, 99);
  for (std::size_t i = 0; i < records.size() / stride; ++i) {
    all += records.substr(i * stride, stride) + values.substr(i * made, made);
  }
  return all;
}

File file_with_everything(int minor, int format) {
  File file;
  file.minor = minor;
  file.format = format;
  file.user_header = "seven..";
  file.vlrs = {vlr("LASF_Projection", 34735, "0123456789"), vlr("me", 4, ""),
               vlr("LASF_Projection", 2112, std::string(70000 / 2, 'w'))};
  file.padding = "\xDD\xCC and more";
  if (minor == 4) file.evlrs = {vlr("me", 7, std::string(100000, 'e'), true), vlr("you", 8, "", true)};
  return file;
}

TEST(LasWriter, ACopyHasTheSameBytesInEveryVersionAndPointFormat) {
  const TemporaryFolder folder;
  for (int minor = 0; minor <= 4; ++minor) {
    for (int format = 0; format <= (minor == 4 ? 10 : minor == 3 ? 5 : minor == 2 ? 3 : 1); ++format) {
      File file = file_with_everything(minor, format);
      EXPECT_TRUE(copy_of(folder, file.bytes()) == file.bytes()) << "1." << minor << " format " << format;
      file.extra_bytes = 7;
      file.vlrs.push_back(vlr("LASF_Spec", 4, descriptor("height", 4, 8, {0.01})));
      EXPECT_TRUE(copy_of(folder, file.bytes()) == file.bytes()) << "1." << minor << " format " << format;
    }
  }
}

TEST(LasWriter, ACopyKeepsBytesBehindThePointsOfOldVersions) {
  const TemporaryFolder folder;
  const std::string bytes = File{}.bytes() + "waveforms or whatever";
  EXPECT_EQ(copy_of(folder, bytes), bytes);
}

TEST(LasWriter, ACopyOfNoPointsIsAFileOfNoPoints) {
  const TemporaryFolder folder;
  File file;
  file.count = 0;
  EXPECT_EQ(copy_of(folder, file.bytes()), file.bytes());
}

TEST(LasWriter, RepairsCountsAndBounds) {
  const TemporaryFolder folder;
  File file;
  file.minor = 4;
  file.format = 6;
  const std::string good = file.bytes();
  std::string bad = good;
  put(bad, 107, std::uint32_t{100});
  put(bad, 111, std::array<std::uint32_t, 5>{1, 2, 3, 4, 5});
  put(bad, 179, std::array<double, 6>{});
  put(bad, 255, std::array<std::uint64_t, 15>{});
  EXPECT_EQ(copy_of(folder, bad), good);
}

TEST(LasWriter, AppendsMadeFieldsAsExtraBytesAndMovesWhatLiesBehind) {
  const TemporaryFolder folder;
  for (int format = 0; format <= 10; ++format) {
    File file = file_with_everything(4, format);
    std::string bytes = file.bytes();
    put(bytes, 227, get<std::uint64_t>(bytes, 235));  // as if the first EVLR were waveforms
    std::filesystem::remove(folder / "in.las");
    std::filesystem::remove(folder / "out.las");
    const auto reader = open_las(folder.write("in.las", bytes));
    OutputPlan plan = plan_like(*reader, folder / "out.las");
    for (const char* name : {"nx", "ny", "nz"}) plan.schema.append(name, Type::f32);
    plan.schema.append("surface_variation", Type::f64);
    const std::string records = with_made(file.points(), file.record_length(), 20);
    const auto writer = create_las_writer(plan);
    writer->write(text_bytes(records));
    writer->finish();

    const std::string out = contents(folder / "out.las");
    std::string expected_vlr = vlr(
        "LASF_Spec", 4,
        descriptor("NormalX", 9) + descriptor("NormalY", 9) + descriptor("NormalZ", 9) + descriptor("Curvature", 10));
    const std::size_t vlrs_end = file.points_at() - file.padding.size();
    const std::size_t points_at = file.points_at() + expected_vlr.size();
    // The descriptions in the header of the VLR and in each descriptor are not compared.
    std::string found_vlr = out.substr(vlrs_end, expected_vlr.size());
    for (std::string* text : {&expected_vlr, &found_vlr}) {
      text->replace(22, 32, 32, ' ');
      for (std::size_t i = 0; i < 4; ++i) text->replace(54 + i * 192 + 160, 32, 32, ' ');
    }
    EXPECT_EQ(found_vlr, expected_vlr);
    EXPECT_EQ(out.substr(file.header_size(), vlrs_end - file.header_size()),
              bytes.substr(file.header_size(), vlrs_end - file.header_size()));
    EXPECT_EQ(out.substr(points_at - file.padding.size(), file.padding.size()), file.padding);
    EXPECT_TRUE(out.substr(points_at, records.size()) == records);
    EXPECT_TRUE(out.substr(points_at + records.size()) == bytes.substr(file.points_at() + file.points().size()));
    // The header is that of the input, except for the following entries.
    std::string header = bytes.substr(0, file.header_size());
    put(header, 96, static_cast<std::uint32_t>(points_at));
    put(header, 100, std::uint32_t{4});
    put(header, 105, static_cast<std::uint16_t>(file.record_length() + 20));
    put(header, 227, std::uint64_t{points_at + records.size()});
    put(header, 235, std::uint64_t{points_at + records.size()});
    EXPECT_EQ(out.substr(0, header.size()), header);

    const auto again = open_las(folder / "out.las");
    EXPECT_TRUE(again->info().warnings.empty());
    EXPECT_EQ(again->info().schema.fields.size(), plan.schema.fields.size());
    EXPECT_TRUE(again->info().schema.find("nx") && again->info().schema.find("surface_variation"));
    EXPECT_TRUE(record_text(*again) == records);
  }
}

TEST(LasWriter, ContinuesTheExtraBytesOfTheInput) {
  const TemporaryFolder folder;
  File file = file_with_everything(2, 3);
  file.extra_bytes = 5;  // 2 bytes with a descriptor, 3 bytes without
  file.vlrs.insert(file.vlrs.begin() + 1, vlr("LASF_Spec", 4, descriptor("width", 4, 8, {0.5})));
  const auto reader = open_las(folder.write("in.las", file.bytes()));
  OutputPlan plan = plan_like(*reader, folder / "out.las");
  plan.schema.append("a", Type::u8);
  plan.schema.append("b", Type::i64, 3);
  const std::string records = with_made(file.points(), file.record_length(), 25);
  const auto writer = create_las_writer(plan);
  writer->write(text_bytes(records));
  writer->finish();
  const auto again = open_las(folder / "out.las");
  const Schema& schema = again->info().schema;
  EXPECT_EQ(get<std::uint32_t>(contents(folder / "out.las"), 100), 4u);
  ASSERT_EQ(schema.fields.size(), reader->info().schema.fields.size() + 5);
  const Field& width = schema.fields[*schema.find("width")];
  EXPECT_EQ(width.offset, 34u);
  EXPECT_EQ(width.scale, 0.5);
  const Field& undocumented = schema.fields[*schema.find("undocumented")];
  EXPECT_EQ(undocumented.offset, 36u);
  EXPECT_EQ(undocumented.count, 3u);
  EXPECT_EQ(schema.fields[*schema.find("a")].offset, 39u);
  EXPECT_EQ(schema.fields[*schema.find("b[2]")].offset, 56u);
  EXPECT_EQ(schema.fields[*schema.find("b[2]")].type, Type::i64);
  EXPECT_TRUE(record_text(*again) == records);
}

TEST(LasWriter, ReplacesAnExtraBytesVlrThatDoesNotFit) {
  const TemporaryFolder folder;
  File file;
  file.vlrs = {vlr("LASF_Spec", 4, descriptor("lie", 10)), vlr("me", 1, "x")};
  const auto reader = open_las(folder.write("in.las", file.bytes()));
  ASSERT_EQ(reader->info().warnings.size(), 1u);
  OutputPlan plan = plan_like(*reader, folder / "out.las");
  plan.schema.append("nx", Type::f32);
  const std::string records = with_made(file.points(), 20, 4);
  const auto writer = create_las_writer(plan);
  writer->write(text_bytes(records));
  writer->finish();
  const auto again = open_las(folder / "out.las");
  EXPECT_TRUE(again->info().warnings.empty());
  EXPECT_FALSE(again->info().schema.find("lie"));
  EXPECT_TRUE(again->info().schema.find("nx"));
  EXPECT_TRUE(record_text(*again) == records);
}

TEST(LasWriter, GivesNewNormalsTheirNameAndKeepsTheOldOnes) {
  const TemporaryFolder folder;
  File file;
  file.extra_bytes = 4;
  file.vlrs = {vlr("LASF_Spec", 4, descriptor("normalx", 9))};
  const auto reader = open_las(folder.write("in.las", file.bytes()));
  OutputPlan plan = plan_like(*reader, folder / "out.las");
  plan.schema.append("nx", Type::f32);
  const auto writer = create_las_writer(plan);
  writer->write(text_bytes(with_made(file.points(), 24, 4)));
  writer->finish();
  const Schema schema = open_las(folder / "out.las")->info().schema;
  EXPECT_EQ(schema.fields[*schema.find("nx")].offset, 24u);
  EXPECT_EQ(schema.fields[*schema.find("NormalX_input")].offset, 20u);
}

TEST(LasWriter, StoresAMadeFieldOfThePointFormatInItsPlace) {
  const TemporaryFolder folder;
  File file;
  const auto reader = open_las(folder.write("in.las", file.bytes()));
  OutputPlan plan = plan_like(*reader, folder / "out.las");
  plan.schema.append("classification", Type::u8);
  std::string records;
  for (std::size_t i = 0; i < file.count; ++i) records += file.points().substr(i * 20, 20) + static_cast<char>(i % 32);
  const auto writer = create_las_writer(plan);
  writer->write(text_bytes(records));
  writer->finish();
  const auto again = open_las(folder / "out.las");
  EXPECT_EQ(again->info().schema, reader->info().schema);
  std::string expected = file.points();
  for (std::size_t i = 0; i < file.count; ++i) {
    char& byte = expected[i * 20 + 15];
    byte = static_cast<char>((byte & 0b1110'0000) | static_cast<int>(i % 32));
  }
  EXPECT_TRUE(record_text(*again) == expected);
}

TEST(LasWriter, AcceptsRowsInAnyOrderAndMoreThanOnce) {
  const TemporaryFolder folder;
  for (const bool twice : {false, true}) {
    for (const int minor : {2, 4}) {
      File file = file_with_everything(minor, minor == 4 ? 6 : 1);
      const auto reader = open_las(folder.write("in.las", file.bytes()));
      OutputPlan plan = plan_like(*reader, folder / "out.las");
      plan.overwrite = true;
      const auto writer = create_las_writer(plan);
      ASSERT_TRUE(writer->can_write_at());
      const std::size_t stride = file.record_length();
      const std::string junk(3 * stride, '\x55');
      if (twice) writer->write_at(60, text_bytes(junk));
      for (const std::size_t row : {70u, 0u, 40u}) {
        writer->write_at(row, text_bytes(file.points().substr(row * stride, 30 * stride)));
      }
      writer->write_at(30, text_bytes(file.points().substr(30 * stride, 10 * stride)));
      writer->finish();
      EXPECT_TRUE(contents(folder / "out.las") == file.bytes()) << minor << twice;
      std::filesystem::remove(folder / "in.las");
    }
  }
}

TEST(LasWriter, MayReplaceItsOwnInput) {
  const TemporaryFolder folder;
  File file = file_with_everything(4, 6);
  const auto reader = open_las(folder.write("in.las", file.bytes()));
  OutputPlan plan = plan_like(*reader, folder / "in.las");
  plan.overwrite = true;
  const auto writer = create_las_writer(plan);
  writer->write(text_bytes(record_text(*reader)));
  writer->finish();
  EXPECT_TRUE(contents(folder / "in.las") == file.bytes());
}

TEST(LasWriter, LeavesNothingBehindWhenRowsAreMissingOrTooMany) {
  const TemporaryFolder folder;
  const File file;
  const auto reader = open_las(folder.write("in.las", file.bytes()));
  {
    const auto writer = create_las_writer(plan_like(*reader, folder / "out.las"));
    writer->write(text_bytes(file.points().substr(20)));
    EXPECT_NE(sentence_of<Error>([&] { writer->finish(); }).find("100 points were announced, but 99 came"),
              std::string::npos);
  }
  {
    const auto writer = create_las_writer(plan_like(*reader, folder / "out.las"));
    EXPECT_THROW(writer->write(text_bytes(file.points() + std::string(20, 'x'))), Error);
    EXPECT_THROW(writer->write_at(101, text_bytes(std::string(20, 'x'))), Error);
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(LasWriter, WhatADamagedFileStillHoldsReachesTheOutput) {
  const TemporaryFolder folder;
  File file;
  file.minor = 4;
  file.format = 7;
  file.extra_bytes = 6;
  file.count = 20;
  file.vlrs = {vlr("LASF_Projection", 34735, std::string(40, 'k')),
               vlr("LASF_Spec", 4, descriptor("Pulse width", 3) + descriptor("Amplitude", 6, 24, {0.5}, {1.0}))};
  file.evlrs = {vlr("me", 1, "abc", true)};
  std::mt19937 random(8);
  int written = 0;
  for (int round = 0; round < 1500; ++round) {
    std::string bytes = file.bytes();
    for (int i = 0; i < 3; ++i) bytes[26 + random() % (file.points_at() - 26)] = static_cast<char>(random());
    std::filesystem::remove(folder / "in.las");
    std::unique_ptr<Reader> reader;
    try {
      reader = open_las(folder.write("in.las", bytes));
    } catch (const Error&) {
      continue;
    }
    OutputPlan plan = plan_like(*reader, folder / "out.las");
    plan.overwrite = true;
    const std::size_t stride = plan.schema.stride;
    plan.schema.append("nx", Type::f32);
    const std::string records = with_made(record_text(*reader), stride, 4);
    const auto writer = create_las_writer(plan);
    writer->write(text_bytes(records));
    writer->finish();
    const auto again = open_las(folder / "out.las");
    ASSERT_TRUE(record_text(*again) == records) << round;
    ASSERT_TRUE(again->info().schema.find("nx")) << round;
    ++written;
  }
  EXPECT_GT(written, 500);
}

TEST(LasWriter, RefusesRecordsLongerThanLasAllows) {
  const TemporaryFolder folder;
  const auto reader = open_las(folder.write("in.las", File{}.bytes()));
  OutputPlan plan = plan_like(*reader, folder / "out.las");
  plan.schema.append("big", Type::f64, 8190);
  EXPECT_NE(sentence_of<Error>([&] { create_las_writer(plan); }).find("'big' does not fit"), std::string::npos);
  plan.schema = reader->info().schema;
  for (int i = 0; i < 400; ++i) plan.schema.append("a" + std::to_string(i), Type::u8);
  EXPECT_NE(sentence_of<Error>([&] { create_las_writer(plan); }).find("'a341' does not fit"), std::string::npos);
}

}  // namespace
}  // namespace pointsweep
