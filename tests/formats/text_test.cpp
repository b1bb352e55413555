// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <bit>
#include <cmath>
#include <limits>

#include "pointsweep/error.h"
#include "pointsweep/formats/field_names.h"
#include "pointsweep/formats/text/text_format.h"
#include "tests/formats/point_files.h"
#include "tests/formats/temporary_folder.h"
#include "tests/support/fixed_seed.h"

namespace pointsweep {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

struct Case {
  const char* what;
  const char* content;
  std::vector<std::string> names;
};

TEST(Text, StatedColumnsCountInPlaceOfAHeaderAndOfTheUsualNames) {
  const std::vector<std::string> columns{"-", "y", "x", "z"};
  const Case cases[] = {
      {"no header", "9 1 2 3\n9 4 nan 6\n", {}},
      {"words in the skipped column", "tree,1,2,3\nbush,4,,6\n", {}},
      {"foreign header", "Point East North Height\n9 1 2 3\n9 4 nan 6\n", {"Point", "East", "North", "Height"}},
      {"title", "Survey of May\n9 1 2 3\n9 4 na 6\n", {"Survey", "of", "May"}},
      {"header", "a x y z\n9 1 2 3\n9 4 nan 6\n", {"a", "x", "y", "z"}},
      {"header in a comment", "# a x y z\n9 1 2 3\n9 4 nan 6\n", {"a", "x", "y", "z"}},
      {"number of points", "2\n9 1 2 3\n9 4 nan 6\n", {}},
  };
  const TemporaryFolder folder;
  for (const Case& c : cases) {
    SCOPED_TRACE(c.what);
    const auto reader = open_text_columns(folder.write("in.txt", c.content), columns);
    EXPECT_THAT(field_names(reader->info().schema), ElementsAre("y", "x", "z"));
    EXPECT_EQ(reader->info().asked_for_as, "text:-,y,x,z");
    ASSERT_EQ(reader->info().count, 2u);
    double values[6];
    ASSERT_EQ(reader->read(0, std::as_writable_bytes(std::span(values))), 2u);
    EXPECT_THAT(std::vector(values, values + 4), ElementsAre(1, 2, 3, 4));
    EXPECT_TRUE(std::isnan(values[4]));
    EXPECT_EQ(values[5], 6);
    EXPECT_EQ(reader->info().warnings.size(), c.names.empty() ? 0 : 1);
  }
  EXPECT_EQ(open_text_columns(folder.write("in.txt", ""), columns)->info().count, 0u);
}

TEST(Text, ReadsTheSameTwoPointsHoweverTheyAreWritten) {
  const std::vector<std::string> xyzi{"x", "y", "z", "intensity"}, upper{"X", "Y", "Z", "I"};
  const Case cases[] = {
      {"spaces", "1 2 3 4\n-5 0.25 1e3 7\n", xyzi},
      {"tabs, carriage returns, blank lines, no last line end", "\r\n1\t2\t3\t4\r\n\r\n -5 0.25 1e3 7", xyzi},
      {"commas and spaces", "1 , 2, 3,4\n-5,0.25,1e3,7\n", xyzi},
      {"semicolons", "1;2;3;4\n-5;0.25;1e3;7\n", xyzi},
      {"trailing separators", "1,2,3,4,\n-5,0.25,1e3,7,\n", xyzi},
      {"header", "X Y Z I\n1 2 3 4\n-5 0.25 1e3 7\n", upper},
      {"quoted header of commas before rows of spaces", "\"X\",\"Y\",\"Z\",\"I\"\n1 2 3 4\n-5 0.25 1e3 7\n", upper},
      {"header in a comment", "# scanned in May\n# X Y Z I\n1 2 3 4\n-5 0.25 1e3 7\n", upper},
      {"header of CloudCompare", "//X,Y,Z,I\n1,2,3,4\n// a remark\n-5,0.25,1e3,7\n", upper},
      {"comment that is no header", "# x y z\n1 2 3 4\n# x y z i\n-5 0.25 1e3 7\n", xyzi},
      {"count", "2\n1 2 3 4\n-5 0.25 1e3 7\n", xyzi},
      {"count, then header in a comment", "2\n# X Y Z I\n1 2 3 4\n-5 0.25 1e3 7\n", upper},
      {"byte order mark",
       "\xef\xbb\xbf"
       "1 2 3 4\n-5 0.25 1e3 7\n",
       xyzi},
      {"byte order mark and header",
       "\xef\xbb\xbf"
       "X,Y,Z,I\n1,2,3,4\n-5,0.25,1e3,7\n",
       upper},
      {"quoted values", "'1' \"2\" 3 4\n-5 \"0.25\" 1e3 +7\n", xyzi},
  };
  const TemporaryFolder folder;
  for (const Case& c : cases) {
    const auto reader = open_text(folder.write("in.txt", c.content));
    ASSERT_EQ(reader->info().count, 2u) << c.what;
    EXPECT_EQ(field_names(reader->info().schema), c.names) << c.what;
    EXPECT_TRUE(reader->info().warnings.empty()) << c.what;
    EXPECT_THAT(values_of(*reader, c.names[0]), ElementsAre(1, -5)) << c.what;
    EXPECT_THAT(values_of(*reader, c.names[1]), ElementsAre(2, 0.25)) << c.what;
    EXPECT_THAT(values_of(*reader, c.names[2]), ElementsAre(3, 1000)) << c.what;
    EXPECT_THAT(values_of(*reader, c.names[3]), ElementsAre(4, 7)) << c.what;
  }
}

TEST(Text, NamesColumnsWithoutHeaderByTheirNumberAndValues) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(default_column_names({}), (Names{"x", "y", "z"}));
  EXPECT_EQ(default_column_names({{1, 2, 3, 4}}), (Names{"x", "y", "z", "intensity"}));
  EXPECT_EQ(default_column_names({{1, 2, 3, 0, 0.6, 0.8}, {1, 2, 3, 0, 0, 0}}),
            (Names{"x", "y", "z", "nx", "ny", "nz"}));
  EXPECT_EQ(default_column_names({{1, 2, 3, 0, 255, 8}}), (Names{"x", "y", "z", "red", "green", "blue"}));
  EXPECT_EQ(default_column_names({{1, 2, 3, 0, 256, 8}}), (Names{"x", "y", "z", "column_4", "column_5", "column_6"}));
  EXPECT_EQ(default_column_names({{1, 2, 3, -900, 1, 2, 3}}),
            (Names{"x", "y", "z", "intensity", "red", "green", "blue"}));
  EXPECT_EQ(default_column_names({{1, 2, 3, 9, 9, 9, 1, 0, 0}}),
            (Names{"x", "y", "z", "red", "green", "blue", "nx", "ny", "nz"}));
  EXPECT_EQ(default_column_names({{1, 2, 3, 4, 5}}), (Names{"x", "y", "z", "column_4", "column_5"}));
}

TEST(Text, WordsForMissingValuesAreNaN) {
  const TemporaryFolder folder;
  const auto reader = open_text(
      folder.write("in.csv", "x,y,z,a\n1,nan,-inf,\n,NA,n/a,2\nNULL,-1.#IND,1.#INF,1e999\n1,2,3,4\n5,6,-1.#INF00,7\n"));
  EXPECT_THAT(values_of(*reader, "x"), ElementsAre(1, testing::IsNan(), testing::IsNan(), 1, 5));
  EXPECT_THAT(values_of(*reader, "y"), ElementsAre(testing::IsNan(), testing::IsNan(), testing::IsNan(), 2, 6));
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_THAT(values_of(*reader, "z"), ElementsAre(-infinity, testing::IsNan(), infinity, 3, -infinity));
  EXPECT_THAT(values_of(*reader, "a"), ElementsAre(testing::IsNan(), 2, infinity, 4, 7));
}

TEST(Text, NumbersBeyondTheRangeOfADoubleAreZeroOrInfinite) {
  const TemporaryFolder folder;
  const std::string zeros(6000, '0'), content = "x,y,z,a\n1e-6000,-1e6000,1,0." + zeros + "1\n-0." + zeros + "1,1" +
                                                zeros + ",1,-1" + zeros + "\n00." + zeros + "1,." + zeros + "1,1,1" +
                                                zeros + "e-9000\n";
  const auto reader = open_text(folder.write("in.csv", content));
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_THAT(values_of(*reader, "x"), ElementsAre(0, 0, 0));
  EXPECT_THAT(values_of(*reader, "y"), ElementsAre(-infinity, infinity, 0));
  EXPECT_THAT(values_of(*reader, "a"), ElementsAre(0, -infinity, 0));
}

const Field& field(const Schema& schema, const char* name) { return schema.fields[schema.find(name).value()]; }

TEST(Text, KeepsAllDigitsOfWholeNumbersOf64Bits) {
  const TemporaryFolder folder;
  const auto reader =
      open_text(folder.write("in.csv",
                             "x,y,z,time,key,small,real\n"
                             "1,2,3,1700000000123456789,18446744073709551615,9007199254740992,1700000000123456789.5\n"
                             "4,5,6,-9223372036854775808,9007199254740993,-7,nan\n"
                             "7,8,9,12.0,+1,1e3,18446744073709551616\n"
                             "7,8,9,1700000000123456787.0,18446744073709551615.0,1,1\n"));
  const Schema& schema = reader->info().schema;
  const std::vector<std::byte> records = all_records(*reader);
  const auto whole_numbers = [&](const char* name) {
    std::vector<std::int64_t> values;
    for (std::size_t row = 0; row < 4; ++row)
      values.push_back(whole_number_of(field(schema, name), records.data() + row * schema.stride));
    return values;
  };
  EXPECT_EQ(field(schema, "time").type, Type::i64);
  EXPECT_THAT(whole_numbers("time"),
              ElementsAre(1700000000123456789, std::numeric_limits<std::int64_t>::min(), 12, 1700000000123456787));
  EXPECT_EQ(field(schema, "key").type, Type::u64);
  EXPECT_THAT(whole_numbers("key"), ElementsAre(-1, 9007199254740993, 1, -1));
  for (const char* name : {"x", "small", "real"}) EXPECT_EQ(field(schema, name).type, Type::f64) << name;
  EXPECT_THAT(values_of(*reader, "small"), ElementsAre(0x1p53, -7, 1000, 1));
  EXPECT_THAT(values_of(*reader, "real"), ElementsAre(1700000000123456789.5, testing::IsNan(), 0x1p64, 1));

  const std::vector<std::string> stated{"x", "y", "z", "time", "-", "-", "-"};
  const auto named = open_text_columns(folder.path() / "in.csv", stated);
  EXPECT_EQ(field(named->info().schema, "time").type, Type::i64);
}

TEST(Text, AWholeNumberThatItsColumnDoesNotHoldIsAnErrorWithItsLine) {
  const TemporaryFolder folder;
  const auto sentence_for = [&](const std::string& content) {
    const auto path = folder.write("in.csv", content);
    return sentence_of<Error>([&] { all_records(*open_text(path)); });
  };
  std::string small = "x,y,z,key\n";
  for (int row = 0; row < 100; ++row) small += "1,2,3,4\n";
  EXPECT_THAT(sentence_for(small + "1,2,3,9007199254740993\n"),
              HasSubstr("line 102: '9007199254740993' in column 'key' cannot be held by float64"));
  EXPECT_EQ(values_of(*open_text(folder.write("even.csv", small + "1,2,3,9007199254740994\n")), "key").back(),
            9007199254740994);
  EXPECT_THAT(sentence_for("x,y,z,key\n1,2,3,nan\n1,2,3,-9007199254740993\n"),
              HasSubstr("line 3: '-9007199254740993' in column 'key' cannot be held by float64"));
  EXPECT_THAT(sentence_for("1 2 9223372036854775807\n"), HasSubstr("in column 'z' cannot be held by float64"));
  EXPECT_THAT(sentence_for("18446744073709551615 2 3\n"), HasSubstr("in column 'x' cannot be held by float64"));
  std::string large = "x,y,z,key\n";
  for (int row = 0; row < 100; ++row) large += "1,2,3,9007199254740993\n";
  EXPECT_THAT(sentence_for(large + "1,2,3,nan\n"),
              HasSubstr("line 102: 'nan' in column 'key' cannot be held by int64"));
  EXPECT_THAT(sentence_for(large + "1,2,3,0.5\n"),
              HasSubstr("line 102: '0.5' in column 'key' cannot be held by int64"));
  for (const char* cell : {"9223372036854775808", "9223372036854775808.0", "1700000000123456789.5", "1e19", "inf"})
    EXPECT_THAT(sentence_for(large + "1,2,3," + cell + "\n"), HasSubstr("cannot be held by int64")) << cell;
}

TEST(Text, AnnouncedCountThatIsWrongIsAWarning) {
  const TemporaryFolder folder;
  const auto reader = open_text(folder.write("in.pts", "9999999999\n1 2 3\n4 5 6\n"));
  EXPECT_EQ(reader->info().count, 2u);
  ASSERT_EQ(reader->info().warnings.size(), 1u);
  EXPECT_THAT(reader->info().warnings[0], HasSubstr("announces 9999999999 points but holds 2"));
}

TEST(Text, FilesWithoutRowsHaveNoPoints) {
  const TemporaryFolder folder;
  for (const char* content : {"\n", "# nothing\n", "x,y,z\n", "0\n"}) {
    EXPECT_EQ(open_text(folder.write("in.txt", content))->info().count, 0u) << content;
  }
}

TEST(Text, SaysInWhichLineSomethingIsWrong) {
  const TemporaryFolder folder;
  const auto sentence_for = [&](const std::string& content) {
    const auto path = folder.write("in.txt", content);
    return sentence_of<Error>([&] { all_records(*open_text(path)); });
  };
  EXPECT_THAT(sentence_for("1 2 3\n\n4 5\n"),
              HasSubstr("line 3 has 2 values where 3 are expected (as in the first row)"));
  EXPECT_THAT(sentence_for("x,y,z\n1,2,3\n1,2,3,4\n"),
              HasSubstr("line 3 has 4 values where 3 are expected (as in the"));
  EXPECT_THAT(sentence_for("1 2 3\n4 5 six\n"), HasSubstr("line 2: 'six' in column 'z' is no number"));
  EXPECT_THAT(sentence_for("X,Y,X\n1,2,3\n"),
              HasSubstr("line 1 is neither numbers nor a header that names x, y and z"));
  EXPECT_THAT(sentence_for("Dear reader,\n"), HasSubstr("line 1 is neither"));
  EXPECT_THAT(sentence_for("1 2\n3 4\n"), HasSubstr("line 1 has 2 values; a point needs x, y and z"));
  EXPECT_THAT(sentence_for("15\n1\n0 0 0\n"), HasSubstr("line 2 has 1 value;"));
  EXPECT_THAT(sentence_for(std::string(3000000, '7')), HasSubstr("line 1 is longer than"));
}

TEST(Text, JumpsGiveTheSameRowsAsReadingOn) {
  const TemporaryFolder folder;
  std::string content = "x y z\n";
  for (int i = 0; i < 140000; ++i) content += fmt::format("{} 0 0\n{}", i, i % 1000 == 0 ? "# a remark\n\n" : "");
  const auto reader = open_text(folder.write("in.txt", content));
  ASSERT_EQ(reader->info().count, 140000u);
  for (const std::uint64_t row : {139999u, 0u, 65536u, 65535u, 131072u, 100000u, 100001u}) {
    std::vector<std::byte> record(reader->info().schema.stride);
    ASSERT_EQ(reader->read(row, record), 1u);
    EXPECT_EQ(value_of(reader->info().schema.fields[0], record.data()), static_cast<double>(row));
  }
}

TEST(Text, NoticesThatRowsHaveVanished) {
  const TemporaryFolder folder;
  const auto reader = open_text(folder.write("in.txt", "1 2 3\n4 5 6\n"));
  std::filesystem::resize_file(folder / "in.txt", 6);
  EXPECT_THAT(sentence_of<Error>([&] { all_records(*reader); }), HasSubstr("fewer rows than when it was opened"));
}

TEST(TextWriter, EveryDoubleSurvivesInEveryExtension) {
  rc::check([] {
    const TemporaryFolder folder;
    const char* const extension = *rc::gen::elementOf(std::vector{".xyz", ".txt", ".csv", ".asc", ".pts"});
    OutputPlan plan = plan_for(folder / (std::string("out") + extension), 0);
    for (const char* name : {"x", "y", "z"}) plan.schema.append(name, Type::f64);
    const auto more = *rc::gen::inRange(0, 6);
    for (int i = 0; i < more; ++i) plan.schema.append(fmt::format("field {}", i), Type::f64);
    plan.count = *rc::gen::inRange<std::uint64_t>(1, 30);
    const auto bits = *rc::gen::container<std::vector<std::uint64_t>>(plan.count * plan.schema.fields.size(),
                                                                      rc::gen::arbitrary<std::uint64_t>());
    std::vector<double> values;
    for (const std::uint64_t b : bits) values.push_back(std::bit_cast<double>(b * 0x9e3779b97f4a7c15u));
    write_all(plan, std::as_bytes(std::span(values)));
    const auto again = open_reader(plan.path);
    RC_ASSERT(again->info().count == plan.count);
    RC_ASSERT(again->info().schema.fields.size() == plan.schema.fields.size());
    const auto records = all_records(*again);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double value = value_of(plan.schema.fields[0], records.data() + 8 * i);
      RC_ASSERT(std::isnan(value) == std::isnan(values[i]));
      RC_ASSERT(std::isnan(value) || std::bit_cast<std::uint64_t>(value) == std::bit_cast<std::uint64_t>(values[i]));
    }
  });
}

TEST(TextWriter, WritesEachTypeInItsShortestForm) {
  const TemporaryFolder folder;
  OutputPlan plan = plan_for(folder / "out.csv", 1);
  for (const char* name : {"x", "y", "z"}) plan.schema.append(name, Type::f32);
  plan.schema.append("id", Type::u64);
  plan.schema.append("class, old", Type::i8);
  plan.schema.append("v", Type::f64, 2);
  std::vector<std::byte> record(plan.schema.stride);
  set_value(plan.schema.fields[0], record.data(), 0.1);
  set_value(plan.schema.fields[1], record.data(), -2);
  const std::uint64_t id = 18446744073709551615u;
  std::memcpy(record.data() + 12, &id, 8);
  set_value(plan.schema.fields[4], record.data(), -7);
  set_value(plan.schema.fields[5], record.data(), 1e300, 1);
  write_all(plan, record);
  EXPECT_EQ(contents(plan.path), "x,y,z,id,class__old,v_0,v_1\n0.1,-2,0,18446744073709551615,-7,0,1e+300\n");
}

TEST(TextWriter, StartsAsProgramsExpectOfTheExtension) {
  const TemporaryFolder folder;
  const auto text_of = [&](const char* name, std::vector<std::string> fields) {
    OutputPlan plan = plan_for(folder / name, 1);
    plan.overwrite = true;
    for (const std::string& field : fields) plan.schema.append(field, Type::u8);
    write_all(plan, std::vector<std::byte>(plan.schema.stride));
    return contents(plan.path);
  };
  EXPECT_EQ(text_of("a.xyz", {"x", "y", "z", "nx"}), "# x y z nx\n0 0 0 0\n");
  EXPECT_EQ(text_of("a.CSV", {"x", "y", "z"}), "x,y,z\n0,0,0\n");
  EXPECT_EQ(text_of("a.pts", {"x", "y", "z", "intensity"}), "1\n0 0 0 0\n");
  EXPECT_EQ(text_of("a.pts", {"x", "y", "z", "nx"}), "1\n# x y z nx\n0 0 0 0\n");
}

TEST(TextWriter, RefusesMoreOrFewerPointsThanAnnounced) {
  const TemporaryFolder folder;
  OutputPlan plan = plan_for(folder / "out.txt", 2);
  for (const char* name : {"x", "y", "z"}) plan.schema.append(name, Type::u8);
  const std::vector<std::byte> records(9);
  EXPECT_THAT(sentence_of<Error>([&] { create_writer(plan)->write(records); }), HasSubstr("more points came"));
  EXPECT_THAT(sentence_of<Error>([&] { create_writer(plan)->finish(); }), HasSubstr("only 0 of the 2 points"));
  EXPECT_FALSE(create_writer(plan)->can_write_at());
  EXPECT_FALSE(std::filesystem::exists(plan.path));
}

/// The file has several scans one after another, each with its number of points.
TEST(Text, PtsOfSeveralScansIsOneCloud) {
  const TemporaryFolder folder;
  const auto reader =
      open_text(folder.write("a.pts", "2\n1 2 3 -2048 255 0 1\n4 5 6 2047 0 0 0\n\n0\r\n 1 \r\n7 8 9 -7 1 2 3\r\n"));
  EXPECT_EQ(values_of(*reader, "x"), (std::vector<double>{1, 4, 7}));
  EXPECT_EQ(values_of(*reader, "intensity"), (std::vector<double>{-2048, 2047, -7}));
  EXPECT_EQ(values_of(*reader, "blue"), (std::vector<double>{1, 0, 3}));
  EXPECT_TRUE(reader->info().warnings.empty());
  const auto first_empty = open_text(folder.write("b.pts", "0\n1\n7 8 9\n"));
  EXPECT_EQ(values_of(*first_empty, "z"), std::vector<double>{9});
  const auto sentence_for = [&](const std::string& text) {
    const auto path = folder.write("c.pts", text);
    return sentence_of<Error>([&] { open_text(path); });
  };
  EXPECT_NE(sentence_for("2\n1 2 3\n5\n7 8 9\n").find("line 3 has 1 value"), std::string::npos);
  EXPECT_NE(sentence_for("2\n1 2 3\n5\n7 8 9\n").find("there are 1 of 2"), std::string::npos);
  EXPECT_NE(sentence_for("1\n1 2 3\nend\n").find("line 3 has 1 value"), std::string::npos);
  const auto short_scan = open_text(folder.write("d.pts", "1\n1 2 3\n5\n7 8 9\n"));
  EXPECT_EQ(short_scan->info().count, 2u);
  ASSERT_EQ(short_scan->info().warnings.size(), 1u);
  EXPECT_NE(short_scan->info().warnings[0].find("announces 6 points but holds 2"), std::string::npos);
}

TEST(Text, BarsSeparateAndPercentSignsBeginComments) {
  const TemporaryFolder folder;
  const auto reader = open_text(folder.write("a.asc", "% Matlab\nX|Y|Z|class\n1|2|3|\n4 | 5 | 6 | 7\n"));
  EXPECT_EQ(reader->info().format, "text, bar separated, with header");
  EXPECT_EQ(values_of(*reader, "Y"), (std::vector<double>{2, 5}));
  EXPECT_EQ(values_of(*reader, "class")[1], 7);
}

}  // namespace
}  // namespace pointsweep
