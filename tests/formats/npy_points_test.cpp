// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

#include "pointsweep/error.h"
#include "pointsweep/formats/npy/npy_format.h"
#include "pointsweep/formats/registry.h"
#include "tests/formats/point_files.h"
#include "tests/formats/temporary_folder.h"

namespace pointsweep {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Numbers = std::vector<double>;

template <class T>
std::string bytes_of(std::initializer_list<T> values, bool reversed = false) {
  std::string bytes;
  for (const T value : values) {
    const std::string one(reinterpret_cast<const char*>(&value), sizeof value);
    bytes += reversed ? std::string(one.rbegin(), one.rend()) : one;
  }
  return bytes;
}

std::string header_of(const std::string& dictionary) {
  std::string file("\x93NUMPY\x01\x00", 8);
  file += static_cast<char>(dictionary.size() & 255);
  file += static_cast<char>(dictionary.size() >> 8);
  return file + dictionary;
}
std::string array_of(const std::string& type, const std::string& shape, const std::string& bytes,
                     bool fortran = false) {
  return header_of(fmt::format("{{'descr': {}, 'fortran_order': {}, 'shape': ({}), }}\n", type,
                               fortran ? "True" : "False", shape)) +
         bytes;
}

/// Returns a zip archive of stored members in the layout of the specification (APPNOTE 6.3). `large`: all sizes and
/// offsets are in the 64-bit records.
std::string archive_of(const std::vector<std::pair<std::string, std::string>>& members, char method = 0,
                       bool large = false) {
  const auto number = [](std::uint64_t value, std::size_t size) {
    return std::string(reinterpret_cast<const char*>(&value), size);
  };
  const auto short_number = [&](std::uint64_t value) { return number(large ? 0xffffffff : value, 4); };
  std::string file, directory;
  for (const auto& [name, content] : members) {
    const std::uint64_t at = file.size(), size = content.size();
    const auto entry = [&](const std::string& extra) {
      return number(20, 2) + number(0, 2) + std::string(1, method) + std::string(1, '\0') + number(0, 8) +
             short_number(size) + short_number(size) + number(name.size(), 2) + number(extra.size(), 2);
    };
    const std::string sizes = number(size, 8) + number(size, 8);
    const std::string local = large ? number(1, 2) + number(16, 2) + sizes : "";
    const std::string central = large ? number(1, 2) + number(24, 2) + sizes + number(at, 8) : "";
    file += "PK\3\4" + entry(local) + name + local + content;
    directory += "PK\1\2" + number(20, 2) + entry(central) + std::string(10, '\0') + short_number(at) + name + central;
  }
  const std::uint64_t begin = file.size(), end = begin + directory.size(), count = members.size();
  file += directory;
  if (large) {
    file += "PK\6\6" + number(44, 8) + number(45, 2) + number(45, 2) + number(0, 8) + number(count, 8) +
            number(count, 8) + number(directory.size(), 8) + number(begin, 8);
    file += "PK\6\7" + number(0, 4) + number(end, 8) + number(1, 4);
  }
  const std::string short_count = number(large ? 0xffff : count, 2);
  return file + "PK\5\6" + number(0, 4) + short_count + short_count + short_number(directory.size()) +
         short_number(begin) + number(0, 2);
}

class NpyPoints : public testing::Test {
 protected:
  std::unique_ptr<Reader> opened(const std::string& bytes) {
    return open_reader(folder_.write(fmt::format("points{}", ++files_), bytes));
  }
  std::string refusal(const std::string& bytes) {
    return sentence_of<Error>([&] { values_of(*opened(bytes), "x"); });
  }
  const TemporaryFolder folder_;
  int files_ = 0;
};

TEST_F(NpyPoints, AreReadInBothOrdersAndByteOrders) {
  for (const bool reversed : {false, true}) {
    const std::string type = reversed ? "'>f4'" : "'<f4'";
    const auto c = opened(array_of(type, "2, 3", bytes_of<float>({1, 2, 3, 4, 5, 6}, reversed)));
    EXPECT_EQ(values_of(*c, "x"), (Numbers{1, 4}));
    EXPECT_EQ(values_of(*c, "z"), (Numbers{3, 6}));
    EXPECT_EQ(c->info().schema.fields[0].type, Type::f32);
    const auto f = opened(array_of(type, "2, 3", bytes_of<float>({1, 4, 2, 5, 3, 6}, reversed), true));
    EXPECT_EQ(all_records(*f), all_records(*c));
  }
}

TEST_F(NpyPoints, KeepTheTypeOfTheirValues) {
  const auto integers = opened(array_of("'<i8'", "1, 4", bytes_of<std::int64_t>({-1, 2, 3, 1LL << 60})));
  EXPECT_EQ(integers->info().schema.fields[3].type, Type::i64);
  EXPECT_EQ(integers->info().schema.fields[3].name, "intensity");
  const auto bytes = opened(array_of("'|u1'", "1, 3", "\xff\x01\x02"));
  EXPECT_EQ(values_of(*bytes, "x"), Numbers{255});
}

TEST_F(NpyPoints, NameColumnsAsTextWithoutHeaderDoes) {
  const auto colored = opened(array_of("'<f8'", "1, 6", bytes_of<double>({1, 2, 3, 0, 128, 255})));
  EXPECT_THAT(field_names(colored->info().schema), ElementsAre("x", "y", "z", "red", "green", "blue"));
  const auto normals = opened(array_of("'<f8'", "1, 6", bytes_of<double>({1, 2, 3, 0.6, 0, 0.8})));
  EXPECT_THAT(field_names(normals->info().schema), ElementsAre("x", "y", "z", "nx", "ny", "nz"));
  const auto others = opened(array_of("'<f8'", "1, 5", bytes_of<double>({1, 2, 3, 4, 5})));
  EXPECT_THAT(field_names(others->info().schema), ElementsAre("x", "y", "z", "column_4", "column_5"));
  EXPECT_EQ(opened(array_of("'<f8'", "0, 3", ""))->info().count, 0u);
}

TEST_F(NpyPoints, StructuredTypesHaveTheirFields) {
  const auto reader = opened(array_of(
      "[('t', '>u2'), ('', '|V2'), ('xyz', '<f4', (3,)), (('the colour', 'rgb'), '|u1', (3,)), ('m', '>f8', (2, 1))]",
      "2,",
      bytes_of<std::uint16_t>({7}, true) + "??" + bytes_of<float>({1, 2, 3}) + "\x0a\x14\x1e" +
          bytes_of<double>({0.5, 0.25}, true) + bytes_of<std::uint16_t>({500}, true) + "??" +
          bytes_of<float>({4, 5, 6}) + "\x0b\x15\x1f" + bytes_of<double>({8, 16}, true)));
  EXPECT_EQ(values_of(*reader, "t"), (Numbers{7, 500}));
  EXPECT_EQ(values_of(*reader, "y"), (Numbers{2, 5}));
  EXPECT_EQ(values_of(*reader, "green"), (Numbers{20, 21}));
  const Schema& schema = reader->info().schema;
  const auto records = all_records(*reader);
  EXPECT_EQ(value_of(schema.fields.back(), records.data() + schema.stride, 1), 16);
}

TEST_F(NpyPoints, OfOrganisedCloudsAreFlattenedWithAWarning) {
  const auto reader = opened(array_of("'<f4'", "1, 2, 3", bytes_of<float>({1, 2, 3, 4, 5, 6})));
  EXPECT_EQ(values_of(*reader, "y"), (Numbers{2, 5}));
  ASSERT_EQ(reader->info().warnings.size(), 1u);
  EXPECT_THAT(reader->info().warnings[0], HasSubstr("an array of 3 axes is not kept"));
  EXPECT_THAT(refusal(array_of("'<f4'", "1, 2, 3", bytes_of<float>({1, 2, 3, 4, 5, 6}), true)),
              HasSubstr("Fortran order and has 3 axes"));
}

TEST_F(NpyPoints, OfArchivesHaveTheArraysOfAsManyRows) {
  for (const bool large : {false, true}) {
    const auto reader =
        opened(archive_of({{"label.npy", array_of("'>i4'", "2,", bytes_of<std::int32_t>({70000, -1}, true))},
                           {"points.npy", array_of("'<f8'", "2, 3", bytes_of<double>({1, 2, 3, 4, 5, 6}))},
                           {"normals.npy", array_of("'<f4'", "2, 3", bytes_of<float>({0, 1, 0, 0, 0, 1}), true)},
                           {"pose.npy", array_of("'<f8'", "4, 4", std::string(128, '\0'))}},
                          0, large));
    EXPECT_EQ(reader->info().format, "NPZ archive of 4 NumPy arrays");
    EXPECT_THAT(field_names(reader->info().schema), ElementsAre("x", "y", "z", "label", "nx", "ny", "nz"));
    EXPECT_EQ(values_of(*reader, "label"), (Numbers{70000, -1}));
    EXPECT_EQ(values_of(*reader, "z"), (Numbers{3, 6}));
    EXPECT_EQ(values_of(*reader, "nx"), (Numbers{0, 1}));
    EXPECT_EQ(values_of(*reader, "nz"), (Numbers{0, 1}));
    ASSERT_EQ(reader->info().warnings.size(), 1u);
    EXPECT_THAT(reader->info().warnings[0], HasSubstr("the array pose is left out"));
  }
  const auto axes = opened(archive_of({{"y.npy", array_of("'<f4'", "1,", bytes_of<float>({2}))},
                                       {"z.npy", array_of("'<f8'", "1,", bytes_of<double>({3}))},
                                       {"x.npy", array_of("'<f4'", "1,", bytes_of<float>({1}))}}));
  EXPECT_EQ(values_of(*axes, "x"), Numbers{1});
  EXPECT_EQ(values_of(*axes, "z"), Numbers{3});
}

TEST_F(NpyPoints, WrongFilesAreOneSentence) {
  const std::string six = bytes_of<float>({1, 2, 3, 4, 5, 6});
  EXPECT_THAT(refusal(array_of("'<f4'", "2, 2", six.substr(8))), HasSubstr("its shape (2, 2) is not that of points"));
  EXPECT_THAT(refusal(array_of("'<f4'", "6,", six)), HasSubstr("its shape (6) is not that of points"));
  EXPECT_THAT(refusal(array_of("'<f4'", "2, 3", six.substr(1))), HasSubstr("but 23 bytes follow"));
  EXPECT_THAT(refusal(array_of("'<f4'", "6148914691236517206, 3", six)), HasSubstr("but 24 bytes follow"));
  EXPECT_THAT(refusal(array_of("'<f4'", "2, 99999999999999999999999", six)), HasSubstr("but 24 bytes follow"));
  EXPECT_THAT(refusal(array_of("'<f2'", "2, 3", six.substr(12))), HasSubstr("holds '<f2'"));
  EXPECT_THAT(refusal(array_of("'|O'", "2, 3", six)), HasSubstr("holds '|O'"));
  EXPECT_THAT(refusal(array_of("[('a', '<f4'), ('b', '<f8')]", "2,", six)), HasSubstr("no x"));
  EXPECT_THAT(refusal(array_of("[('x', [('y', '<f4')])]", "6,", six)), HasSubstr("has fields itself"));
  EXPECT_THAT(refusal(array_of("[('x', '<f4', (99999999, 99999999))]", "1,", six)),
              HasSubstr("more than 1048576 values"));
  EXPECT_THAT(refusal(array_of("[('x', '<f4', (0,))]", "1,", "")), HasSubstr("no values"));
  EXPECT_THAT(refusal(header_of("{'descr': '<f4', 'shape': (2, 3)}") + six), HasSubstr("has no 'fortran_order'"));
  EXPECT_THAT(refusal(header_of("{'descr': ((((((((((((1))))))))))))}")), HasSubstr("its header is damaged"));
  EXPECT_THAT(refusal(array_of("'<f4'", "2, 3", six).substr(0, 60)), HasSubstr("cut off or too long"));
}

TEST_F(NpyPoints, WrongArchivesAreOneSentence) {
  const std::string points = array_of("'<f4'", "1, 3", bytes_of<float>({1, 2, 3}));
  const std::string good = archive_of({{"points.npy", points}});
  EXPECT_EQ(values_of(*opened(good), "y"), Numbers{2});
  EXPECT_THAT(refusal(archive_of({{"points.npy", points}}, 8)), HasSubstr("is compressed"));
  EXPECT_THAT(refusal(archive_of({{"a.npy", points}, {"b.npy", points}})), HasSubstr("several of its 2 arrays"));
  EXPECT_THAT(refusal(archive_of({{"a.npy", array_of("'<f4'", "3,", bytes_of<float>({1, 2, 3}))},
                                  {"b.npy", array_of("'<f4'", "3,", bytes_of<float>({1, 2, 3}))}})),
              HasSubstr("none of its 2 arrays"));
  EXPECT_THAT(refusal(archive_of({{"points.npy", points.substr(1)}})), HasSubstr("is no NumPy array"));
  for (std::size_t bytes = 40; bytes < good.size(); ++bytes)
    EXPECT_THROW(opened(good.substr(0, bytes)), Error) << bytes;
  EXPECT_THAT(refusal(archive_of({{"notes.txt", "1 2 3\n"}})), HasSubstr("is a zip archive"));
  // Damages each byte of the directory, so that some entries refer to places outside of the file. At most an Error is
  // thrown.
  for (std::size_t at = good.find("PK\1\2"); at < good.size(); ++at) {
    std::string wrong = good;
    wrong[at] = static_cast<char>(wrong[at] ^ 0x7f);
    try {
      opened(wrong);
    } catch (const Error&) {
    }
  }
}

TEST_F(NpyPoints, AreReadInAnyOrder) {
  std::string bytes;
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < 100000; ++i) bytes += bytes_of<float>({static_cast<float>(i + axis)});
  const auto reader = opened(array_of("'<f4'", "100000, 3", bytes, true));
  std::vector<std::byte> record(reader->info().schema.stride);
  for (const std::uint64_t row : {99999, 5, 65536, 65535, 0}) {
    ASSERT_EQ(reader->read(row, record), 1u);
    EXPECT_EQ(value_of(reader->info().schema.fields[2], record.data()), static_cast<double>(row + 2));
  }
  const Numbers z = values_of(*reader, "z");
  for (std::size_t i = 0; i < z.size(); ++i) ASSERT_EQ(z[i], static_cast<double>(i + 2));
}

}  // namespace
}  // namespace pointsweep
