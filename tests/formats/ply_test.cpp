// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "pointsweep/error.h"
#include "pointsweep/formats/ply/ply_format.h"
#include "tests/formats/point_files.h"
#include "tests/formats/temporary_folder.h"
#include "tests/support/fixed_seed.h"

namespace pointsweep {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Returns the bytes of a value, the lowest first, or the highest first with `big_endian`.
template <class T>
std::string value_bytes(T value, bool big_endian = false) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  if (big_endian) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

/// Returns the sentence of the Error that opening and reading a file of this content throws.
std::string sentence_for(const std::string& content) {
  const TemporaryFolder folder;
  const auto path = folder.write("in.ply", content);
  return sentence_of<Error>([&] { all_records(*open_ply(path)); });
}

const std::string kVertexXyz = "property float x\nproperty float y\nproperty float z\n";

TEST(Ply, ReadsAsciiWithCommentsCarriageReturnsTrailingSpacesAndBlankLines) {
  const TemporaryFolder folder;
  const auto reader = open_ply(folder.write("in.ply",
                                            "ply\r\nformat ascii 1.0\r\ncomment made by hand\r\nobj_info num_cols 2\r\n"
                                            "element vertex 2\r\nproperty double x\r\nproperty float32 y\r\n"
                                            "property int z \r\nproperty uchar red\r\nend_header\r\n"
                                            "0.1 0.5  -7 255  \r\n\r\n +1e3\tnan 2.0 0\r\n"));
  EXPECT_EQ(reader->info().format, "PLY 1.0 ascii");
  EXPECT_EQ(reader->info().count, 2u);
  EXPECT_EQ(reader->info().schema.fields[3].type, Type::u8);
  EXPECT_THAT(values_of(*reader, "x"), ElementsAre(0.1, 1000));
  EXPECT_THAT(values_of(*reader, "z"), ElementsAre(-7, 2));
  EXPECT_TRUE(std::isnan(values_of(*reader, "y")[1]));
  EXPECT_TRUE(reader->info().warnings.empty());
}

TEST(Ply, ReadsTheLastLineWithoutItsEnd) {
  const TemporaryFolder folder;
  const auto reader =
      open_ply(folder.write("in.ply", "ply\nformat ascii 1.0\nelement vertex 1\n" + kVertexXyz + "end_header\n1 2 3"));
  EXPECT_THAT(values_of(*reader, "z"), ElementsAre(3));
}

TEST(Ply, JumpsInAsciiGiveTheSameRowsAsReadingOn) {
  const TemporaryFolder folder;
  std::string content = "ply\nformat ascii 1.0\nelement vertex 150000\n" + kVertexXyz + "end_header\n";
  for (int i = 0; i < 150000; ++i) content += fmt::format("{} 0 0\n", i);
  const auto reader = open_ply(folder.write("in.ply", content));
  for (const std::uint64_t row : {149999u, 0u, 65535u, 65536u, 65537u, 140000u, 70000u, 131072u}) {
    std::vector<std::byte> records(2 * reader->info().schema.stride);
    const std::size_t rows = reader->read(row, records);
    ASSERT_EQ(rows, row == 149999u ? 1u : 2u);
    EXPECT_EQ(value_of(reader->info().schema.fields[0], records.data()), static_cast<double>(row));
  }
  std::vector<std::byte> records(100);
  EXPECT_EQ(reader->read(150000, records), 0u);
}

/// Returns a file with two elements before the vertices: one has lists, the other has a fixed size.
std::string binary_file(bool big_endian) {
  std::string content = fmt::format("ply\nformat binary_{}_endian 1.0\n", big_endian ? "big" : "little");
  content += "element face 2\nproperty list uchar int vertex_indices\nproperty short flag\n";
  content += "element camera 3\nproperty double focus\nproperty uchar id\n";
  content += "element vertex 2\nproperty double x\nproperty float y\nproperty int16 z\nproperty uint64 id\n";
  content += "element strip 1\nproperty list int int items\nend_header\n";
  const auto add = [&](auto value) { content += value_bytes(value, big_endian); };
  add(std::uint8_t{3}), add(0), add(1), add(2), add(std::int16_t{-1});
  add(std::uint8_t{0}), add(std::int16_t{5});
  for (int i = 0; i < 3; ++i) add(35.5), add(std::uint8_t{9});
  add(1e6 + 0.001), add(-2.5f), add(std::int16_t{-300}), add(std::uint64_t{1} << 63);
  add(-1e6), add(0.25f), add(std::int16_t{7}), add(std::uint64_t{12345678901234567u});
  add(std::int32_t{-1});
  return content;
}

TEST(Ply, WalksPastOtherElementsAndSaysThatTheyAreNotKept) {
  const TemporaryFolder folder;
  const auto reader = open_ply(folder.write("in.ply", binary_file(false)));
  EXPECT_THAT(values_of(*reader, "x"), ElementsAre(1e6 + 0.001, -1e6));
  EXPECT_THAT(values_of(*reader, "z"), ElementsAre(-300, 7));
  ASSERT_EQ(reader->info().warnings.size(), 3u);
  EXPECT_THAT(reader->info().warnings[0], HasSubstr("the 2 entries of element 'face' are not kept"));
}

TEST(Ply, BigEndianGivesTheRecordsOfLittleEndian) {
  const TemporaryFolder folder;
  const auto little = open_ply(folder.write("little.ply", binary_file(false)));
  const auto big = open_ply(folder.write("big.ply", binary_file(true)));
  EXPECT_EQ(little->info().schema, big->info().schema);
  EXPECT_EQ(all_records(*little), all_records(*big));
}

TEST(Ply, ACarriageReturnBehindEndHeaderBelongsToTheHeader) {
  const TemporaryFolder folder;
  const std::string header =
      "ply\r\nformat binary_little_endian 1.0\r\nelement vertex 1\r\nproperty float x\r\n"
      "property float y\r\nproperty float z\r\nend_header\r\n";
  const auto reader = open_ply(folder.write("in.ply", header + value_bytes(1.f) + value_bytes(2.f) + value_bytes(3.f)));
  EXPECT_THAT(values_of(*reader, "z"), ElementsAre(3));
}

TEST(Ply, TruncatedFilesSayHowManyVerticesAreMissing) {
  EXPECT_THAT(sentence_for("ply\nformat ascii 1.0\nelement vertex 3\n" + kVertexXyz + "end_header\n1 2 3\n4 5 6\n"),
              HasSubstr("the header says 3 vertices, but the file ends after 2"));
  const std::string header = "ply\nformat binary_little_endian 1.0\nelement vertex 3\n" + kVertexXyz + "end_header\n";
  EXPECT_THAT(sentence_for(header + std::string(35, 'a')), HasSubstr("says 3 vertices, but the file ends after 2"));
  const std::string file = binary_file(false);
  const std::size_t body = file.find("end_header\n") + 11;
  EXPECT_THAT(sentence_for(file.substr(0, body + 10)), HasSubstr("ends inside element 'face'"));
  EXPECT_THAT(sentence_for(file.substr(0, body + 20)), HasSubstr("ends inside element 'camera'"));
}

TEST(Ply, CountsThatLieAreRefusedAtOnce) {
  for (const char* encoding : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    for (const char* count : {"18446744073709551615", "1000000000000", "4294967297"}) {
      const std::string start = fmt::format("ply\nformat {} 1.0\n", encoding);
      EXPECT_THAT(sentence_for(start + fmt::format("element vertex {}\n", count) + kVertexXyz + "end_header\n1 2 3\n"),
                  HasSubstr(fmt::format("the header says {} vertices", count)));
      EXPECT_THAT(sentence_for(start + fmt::format("element face {}\nproperty list uint double a\n", count) +
                               "element vertex 0\n" + kVertexXyz + "end_header\n\xff\xff\xff\xff"),
                  HasSubstr("ends inside element 'face'"));
    }
  }
}

TEST(Ply, SaysWhatIsWrongInAHeaderAndWhere) {
  const auto header = [](const std::string& lines) { return "ply\nformat ascii 1.0\n" + lines + "end_header\n"; };
  EXPECT_THAT(sentence_for(header("element vertex -1\n")),
              HasSubstr("line 3: an element line is 'element NAME COUNT'"));
  EXPECT_THAT(sentence_for(header("element vertex 1\nproperty word x\n")), HasSubstr("line 4: 'word' is no type"));
  EXPECT_THAT(sentence_for(header("property float x\n")), HasSubstr("line 3: a property comes before any element"));
  EXPECT_THAT(sentence_for(header("elephant vertex 1\n")), HasSubstr("line 3: 'elephant' is no word"));
  EXPECT_THAT(sentence_for(header("element vertex 1\nelement vertex 1\n")), HasSubstr("declared twice"));
  EXPECT_THAT(sentence_for(header("element face 1\nproperty list float int i\n")), HasSubstr("count of a list"));
  EXPECT_THAT(sentence_for("ply\nformat binary 1.0\nend_header\n"), HasSubstr("encoding 'binary'"));
  EXPECT_THAT(sentence_for("ply\nformat ascii 2.0\nend_header\n"), HasSubstr("version 2.0 is not known"));
  EXPECT_THAT(sentence_for("ply\nelement vertex 0\nend_header\n"), HasSubstr("without a 'format' line"));
  EXPECT_THAT(sentence_for("ply\nformat ascii 1.0\n"), HasSubstr("no 'end_header' line"));
  EXPECT_THAT(sentence_for("ply\n" + std::string(2000000, 'c')), HasSubstr("line 2 is longer than"));
  std::string endless = "ply\n";
  for (int i = 0; i < 200000; ++i) endless += "comment\n";
  EXPECT_THAT(sentence_for(endless), HasSubstr("no 'end_header' line"));
}

TEST(Ply, SaysWhatIsWrongWithTheVertices) {
  const auto file = [](const std::string& properties, const std::string& rows) {
    return "ply\nformat ascii 1.0\nelement vertex 1\n" + properties + "end_header\n" + rows;
  };
  EXPECT_THAT(sentence_for(file("property float x\nproperty float y\n", "1 2\n")), HasSubstr("have no z"));
  EXPECT_THAT(sentence_for(file(kVertexXyz + "property list uchar int i\n", "")), HasSubstr("property 'i' gives each"));
  EXPECT_THAT(sentence_for(file(kVertexXyz, "1 2\n")), HasSubstr("line 8: has fewer than the 3 values"));
  EXPECT_THAT(sentence_for(file(kVertexXyz, "1 2 3 4\n")), HasSubstr("line 8: has more than the 3 values"));
  EXPECT_THAT(sentence_for(file(kVertexXyz, "1 2 three\n")), HasSubstr("'three' is no float32 for the property 'z'"));
  EXPECT_THAT(sentence_for(file(kVertexXyz + "property uchar i\n", "1 2 3 256\n")), HasSubstr("'256' is no uint8"));
  EXPECT_THAT(sentence_for("ply\nformat ascii 1.0\nelement face 0\nend_header\n"),
              HasSubstr("has no element 'vertex' and so no points (elements found: face)"));
}

TEST(Ply, NoticesThatTheFileBecameShorterWhileItWasRead) {
  const TemporaryFolder folder;
  const std::string header = "ply\nformat binary_little_endian 1.0\nelement vertex 2\n" + kVertexXyz + "end_header\n";
  const auto path = folder.write("in.ply", header + std::string(24, 'a'));
  const auto reader = open_ply(path);
  std::filesystem::resize_file(path, header.size() + 20);
  EXPECT_THAT(sentence_of<Error>([&] { all_records(*reader); }), HasSubstr("it has become shorter"));
}

TEST(PlyWriter, GivesBackEveryByteOfAnySchemaThatPlyCanHold) {
  rc::check([] {
    const TemporaryFolder folder;
    OutputPlan plan = plan_for(folder / "out.ply", 0);
    for (const char* name : {"x", "y", "z"})
      plan.schema.append(name, *rc::gen::elementOf(std::vector{Type::f32, Type::f64, Type::i32}));
    const auto more = *rc::gen::inRange(0, 8);
    for (int i = 0; i < more; ++i) {
      plan.schema.append(fmt::format("field{}", i),
                         *rc::gen::elementOf(std::vector{Type::i8, Type::u8, Type::i16, Type::u16, Type::i32, Type::u32,
                                                         Type::f32, Type::f64}));
    }
    plan.count = *rc::gen::inRange<std::uint64_t>(0, 50);
    const auto bytes = *rc::gen::container<std::vector<std::uint8_t>>(plan.count * plan.schema.stride,
                                                                      rc::gen::arbitrary<std::uint8_t>());
    const auto records = std::as_bytes(std::span(bytes));
    write_all(plan, records);
    const auto reader = open_ply(plan.path);
    RC_ASSERT(reader->info().schema == plan.schema);
    RC_ASSERT(reader->info().count == plan.count);
    const auto again = all_records(*reader, 7);
    RC_ASSERT(std::equal(again.begin(), again.end(), records.begin(), records.end()));
  });
}

TEST(PlyWriter, DecodesScaledAndBitFieldsAndLeavesGapsOut) {
  const TemporaryFolder folder;
  OutputPlan plan = plan_for(folder / "out.ply", 1);
  for (const char* name : {"x", "y", "z"}) {
    Field& field = plan.schema.fields[plan.schema.append(name, Type::i32)];
    field.scale = 0.01;
    field.bias = 500000;
  }
  plan.schema.append("flags", Type::u8);
  Field second = plan.schema.fields.back();
  plan.schema.fields.back().bit_width = 3;
  second.name = "second flag";
  second.bit_shift = 3;
  second.bit_width = 5;
  plan.schema.fields.push_back(second);
  plan.schema.stride += 5;
  plan.schema.append("vector", Type::f32, 2);
  std::vector<std::byte> record(plan.schema.stride);
  set_value(plan.schema.fields[0], record.data(), 500123.45);
  set_value(plan.schema.fields[3], record.data(), 5);
  set_value(plan.schema.fields[4], record.data(), 17);
  set_value(plan.schema.fields[5], record.data(), 0.5, 1);
  write_all(plan, record);
  const auto reader = open_ply(plan.path);
  EXPECT_THAT(field_names(reader->info().schema),
              ElementsAre("x", "y", "z", "flags", "second_flag", "vector_0", "vector_1"));
  EXPECT_EQ(reader->info().schema.fields[0].type, Type::f64);
  EXPECT_EQ(reader->info().schema.fields[3].type, Type::u8);
  EXPECT_THAT(values_of(*reader, "x"), ElementsAre(value_of(plan.schema.fields[0], record.data())));
  EXPECT_THAT(values_of(*reader, "flags"), ElementsAre(5));
  EXPECT_THAT(values_of(*reader, "second_flag"), ElementsAre(17));
  EXPECT_THAT(values_of(*reader, "vector_1"), ElementsAre(0.5));
}

TEST(PlyWriter, KeepsCommentsObjInfoAnd64BitIntegersOfAPlyInput) {
  const TemporaryFolder folder;
  std::string content = binary_file(false);
  content.insert(content.find("element face"), "comment TextureFile a.png\nobj_info  is_mesh 0\n");
  const auto reader = open_ply(folder.write("in.ply", content));
  const auto& info = reader->info();
  OutputPlan plan = plan_for(folder / "out.ply", info.count, info.schema);
  plan.extras = info.extras;
  write_all(plan, all_records(*reader));
  EXPECT_THAT(contents(folder / "out.ply"),
              HasSubstr("1.0\ncomment TextureFile a.png\nobj_info  is_mesh 0\nelement vertex"));
  const auto again = open_ply(folder / "out.ply");
  EXPECT_EQ(again->info().schema, info.schema);
  EXPECT_EQ(all_records(*again), all_records(*reader));
}

TEST(PlyWriter, Stores64BitIntegersAsDoubleAndRefusesToRoundThem) {
  const TemporaryFolder folder;
  OutputPlan plan = plan_for(folder / "out.ply", 1);
  for (const char* name : {"x", "y", "z"}) plan.schema.append(name, Type::f32);
  plan.schema.append("id", Type::u64);
  std::vector<std::byte> record(plan.schema.stride);
  const auto set_id = [&](std::uint64_t id) { std::memcpy(record.data() + 12, &id, 8); };
  set_id(std::uint64_t{1} << 53);
  write_all(plan, record);
  EXPECT_THAT(values_of(*open_ply(plan.path), "id"), ElementsAre(9007199254740992.0));
  plan.overwrite = true;
  for (const std::uint64_t id : {(std::uint64_t{1} << 53) + 1, ~std::uint64_t{0}}) {
    set_id(id);
    EXPECT_THAT(sentence_of<Error>([&] { write_all(plan, record); }), HasSubstr("'id' needs all of its 64"));
  }
}

TEST(PlyWriter, WritesRowsInAnyOrder) {
  const TemporaryFolder folder;
  OutputPlan plan = plan_for(folder / "out.ply", 3);
  for (const char* name : {"x", "y", "z"}) plan.schema.append(name, Type::f64);
  std::vector<double> values{0, 1, 2, 3, 4, 5, 6, 7, 8};
  const auto records = std::as_bytes(std::span(values));
  const auto writer = create_writer(plan);
  ASSERT_TRUE(writer->can_write_at());
  writer->write_at(2, records.subspan(48));
  writer->write_at(0, records.first(48));
  writer->finish();
  EXPECT_THAT(values_of(*open_ply(plan.path), "z"), ElementsAre(2, 5, 8));
  EXPECT_EQ(writer->bytes_written(), std::filesystem::file_size(plan.path));
}

TEST(PlyWriter, RefusesMoreOrFewerPointsThanAnnounced) {
  const TemporaryFolder folder;
  OutputPlan plan = plan_for(folder / "out.ply", 2);
  for (const char* name : {"x", "y", "z"}) plan.schema.append(name, Type::f32);
  const std::vector<std::byte> records(3 * plan.schema.stride);
  EXPECT_THAT(sentence_of<Error>([&] { create_writer(plan)->write(records); }),
              HasSubstr("more points came than the 2"));
  EXPECT_THAT(sentence_of<Error>([&] {
                const auto writer = create_writer(plan);
                writer->write(std::span(records).first(12));
                writer->finish();
              }),
              HasSubstr("only 1 of the 2 points"));
  EXPECT_FALSE(std::filesystem::exists(plan.path));
}

}  // namespace
}  // namespace pointsweep
