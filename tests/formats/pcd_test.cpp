// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <random>

#include "pointsweep/error.h"
#include "pointsweep/formats/pcd/lzf_stream.h"
#include "pointsweep/formats/pcd/pcd_format.h"
#include "tests/formats/point_files.h"
#include "tests/formats/temporary_folder.h"
#include "tests/support/data_folder.h"

namespace pointsweep {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Compresses bytes as LZF, written from its description. Matches the last place that begins with the same three bytes.
std::string lzf(const std::string& plain) {
  std::string out, literals;
  std::map<std::string, std::size_t> last;
  const auto flush = [&] {
    for (std::size_t at = 0; at < literals.size(); at += 32) {
      const std::string run = literals.substr(at, 32);
      out += static_cast<char>(run.size() - 1) + run;
    }
    literals.clear();
  };
  for (std::size_t i = 0; i < plain.size();) {
    const auto found = last.find(plain.substr(i, 3));
    std::size_t length = 0;
    if (i + 3 <= plain.size() && found != last.end() && i - found->second <= 8192)
      while (length < 264 && i + length < plain.size() && plain[found->second + length] == plain[i + length]) ++length;
    const std::size_t distance = length >= 3 ? i - found->second - 1 : 0;
    if (length >= 3) {
      flush();
      const std::size_t stored = length - 2;
      out += static_cast<char>(std::min<std::size_t>(stored, 7) << 5 | distance >> 8);
      if (stored >= 7) out += static_cast<char>(stored - 7);
      out += static_cast<char>(distance & 255);
    } else {
      length = 1;
      literals += plain[i];
    }
    for (std::size_t end = i + length; i < end; ++i)
      if (i + 3 <= plain.size()) last[plain.substr(i, 3)] = i;
  }
  flush();
  return out;
}

template <class T>
std::string raw_bytes(const T& value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

/// A point with padding, an array, a packed colour and a wide integer.
struct Row {
  float x, y, z;
  std::uint8_t padding[3];
  std::uint32_t rgb;
  std::int16_t pair[2];
  double time;
};

std::vector<Row> some_rows(std::size_t count) {
  std::mt19937 random(1);
  std::vector<Row> rows;
  for (std::size_t i = 0; i < count; ++i) {
    const auto n = static_cast<float>(random() % 100);
    rows.push_back({n,
                    static_cast<float>(i) * 0.5f,
                    -n,
                    {1, 2, 3},
                    static_cast<std::uint32_t>(random() & 0xFFFFFF),
                    {static_cast<std::int16_t>(i % 7), -3},
                    static_cast<double>(i) + 0.125});
  }
  if (count > 2) rows[2].x = std::nanf("");
  return rows;
}

constexpr std::uint32_t kSizes[] = {4, 4, 4, 3, 4, 4, 8};

std::vector<std::string> values_of_row(const Row& r) {
  return {raw_bytes(r.x),   raw_bytes(r.y),    raw_bytes(r.z),   raw_bytes(r.padding),
          raw_bytes(r.rgb), raw_bytes(r.pair), raw_bytes(r.time)};
}

std::string header(std::size_t points, const std::string& data, const std::string& more = "") {
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z _ rgb pair time\nSIZE 4 4 4 1 4 2 8\n"
         "TYPE F F F U U I F\nCOUNT 1 1 1 3 1 2 1\nWIDTH " +
         std::to_string(points) + "\nHEIGHT 1\n" + more + "POINTS " + std::to_string(points) + "\nDATA " + data + "\n";
}

std::string ascii_body(const std::vector<Row>& rows) {
  std::string body;
  for (const Row& r : rows)
    body += fmt::format("{} {} {} 1 2 3 {} {} {} {}\n", r.x, r.y, r.z, r.rgb, r.pair[0], r.pair[1], r.time);
  return body;
}

std::string binary_body(const std::vector<Row>& rows) {
  std::string body;
  for (const Row& r : rows)
    for (const std::string& value : values_of_row(r)) body += value;
  return body;
}

std::string compressed_body(const std::vector<Row>& rows) {
  std::string plain;
  for (std::size_t f = 0; f < std::size(kSizes); ++f)
    for (const Row& r : rows) plain += values_of_row(r)[f];
  const std::string packed = lzf(plain);
  return raw_bytes(static_cast<std::uint32_t>(packed.size())) + raw_bytes(static_cast<std::uint32_t>(plain.size())) +
         packed;
}

void expect_rows(Reader& reader, const std::vector<Row>& rows) {
  ASSERT_EQ(reader.info().count, rows.size());
  EXPECT_THAT(field_names(reader.info().schema), ElementsAre("x", "y", "z", "red", "green", "blue", "pair", "time"));
  const auto x = values_of(reader, "x"), y = values_of(reader, "y"), red = values_of(reader, "red"),
             green = values_of(reader, "green"), blue = values_of(reader, "blue"), pair = values_of(reader, "pair"),
             time = values_of(reader, "time");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ASSERT_TRUE(x[i] == rows[i].x || std::isnan(rows[i].x)) << i;
    ASSERT_EQ(std::isnan(x[i]), std::isnan(rows[i].x)) << i;
    ASSERT_EQ(y[i], rows[i].y) << i;
    ASSERT_EQ(red[i], rows[i].rgb >> 16) << i;
    ASSERT_EQ(green[i], rows[i].rgb >> 8 & 255) << i;
    ASSERT_EQ(blue[i], rows[i].rgb & 255) << i;
    ASSERT_EQ(pair[i], rows[i].pair[0]) << i;
    ASSERT_EQ(time[i], rows[i].time) << i;
  }
}

TEST(Pcd, AllEncodingsGiveTheSamePoints) {
  const TemporaryFolder folder;
  const std::vector<Row> rows = some_rows(3000);
  folder.write("ascii.pcd", header(rows.size(), "ascii") + ascii_body(rows));
  folder.write("binary.pcd", header(rows.size(), "binary") + binary_body(rows));
  folder.write("padded.pcd", header(rows.size(), "binary") + binary_body(rows) + std::string(4096, '\0'));
  folder.write("compressed.pcd", header(rows.size(), "binary_compressed") + compressed_body(rows));
  for (const char* name : {"ascii.pcd", "binary.pcd", "padded.pcd", "compressed.pcd"}) {
    SCOPED_TRACE(name);
    const auto reader = open_reader(folder / name);
    expect_rows(*reader, rows);
  }
}

TEST(Pcd, JumpsReadTheSameRecordsAsReadingThrough) {
  const TemporaryFolder folder;
  const std::vector<Row> rows = some_rows(5000);
  folder.write("compressed.pcd", header(rows.size(), "binary_compressed") + compressed_body(rows));
  folder.write("ascii.pcd", header(rows.size(), "ascii") + ascii_body(rows));
  for (const char* name : {"compressed.pcd", "ascii.pcd"}) {
    const auto reader = open_reader(folder / name);
    const std::size_t stride = reader->info().schema.stride;
    const std::vector<std::byte> all = all_records(*reader);
    std::mt19937 random(2);
    std::vector<std::byte> some;
    for (int i = 0; i < 40; ++i) {
      const std::size_t row = random() % rows.size(), count = 1 + random() % 700;
      some.resize(count * stride);
      const std::size_t read = reader->read(row, some);
      ASSERT_EQ(read, std::min(count, rows.size() - row));
      ASSERT_EQ(std::memcmp(some.data(), all.data() + row * stride, read * stride), 0) << name << " " << row;
    }
    some.resize(stride);
    EXPECT_EQ(reader->read(rows.size(), some), 0u);
  }
}

TEST(Pcd, ACompressedFileThatIsCutAnywhereIsRefused) {
  const TemporaryFolder folder;
  const std::vector<Row> rows = some_rows(60);
  for (const auto& [data, body] : {std::pair{"binary_compressed", compressed_body(rows)},
                                   {"binary", binary_body(rows)},
                                   {"ascii", ascii_body(rows)}}) {
    const std::string whole = header(rows.size(), data) + body;
    for (std::size_t size = 1; size + 1 < whole.size(); size += 1 + size / 40) {
      folder.write("cut.pcd", whole.substr(0, size));
      if (std::string_view(data) == "ascii" && size + 30 > whole.size()) continue;  // a cut last number is a number
      EXPECT_THROW(open_pcd(folder / "cut.pcd"), Error) << data << " cut after " << size;
    }
  }
}

TEST(Pcd, DamagedCompressedDataEndInASentence) {
  const TemporaryFolder folder;
  const std::vector<Row> rows = some_rows(200);
  const std::string whole = header(rows.size(), "binary_compressed") + compressed_body(rows);
  std::mt19937 random(3);
  int refused = 0;
  for (int i = 0; i < 300; ++i) {
    std::string damaged = whole;
    damaged[whole.size() / 2 + random() % (whole.size() / 2)] = static_cast<char>(random());
    folder.write("damaged.pcd", damaged);
    try {
      const auto reader = open_pcd(folder / "damaged.pcd");
      all_records(*reader);
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr("damaged"));
      ++refused;
    }
  }
  EXPECT_GT(refused, 10);
}

std::string refusal(const TemporaryFolder& folder, const std::string& content) {
  folder.write("a.pcd", content);
  try {
    open_pcd(folder / "a.pcd");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Pcd, WrongHeadersAreNamed) {
  const TemporaryFolder folder;
  const std::string begin = "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\n";
  EXPECT_THAT(refusal(folder, begin + "SIZE 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\n1 2 3\n"),
              HasSubstr("names 3 fields, but has 2 sizes"));
  EXPECT_THAT(refusal(folder, begin + "SIZE 4 4 3\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2 3\n"),
              HasSubstr("'z' has the type F with 3 bytes"));
  EXPECT_THAT(refusal(folder, begin + "SIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA zipped\n"), HasSubstr("DATA zipped"));
  EXPECT_THAT(refusal(folder, begin + "SIZE 4 4 4\nTYPE F F F\nPOINTS 1\n"), HasSubstr("without the line DATA"));
  EXPECT_THAT(refusal(folder, begin + "SIZE 4 4 4\nTYPE F F F\nPOINTS many\nDATA ascii\n"),
              HasSubstr("a whole number is missing"));
  EXPECT_THAT(
      refusal(folder,
              "# .PCD v0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 9999999999\nPOINTS 1\nDATA binary\n"),
      HasSubstr("larger than 1 MB"));
  EXPECT_THAT(refusal(folder, begin + "SIZE 4 4 4\nTYPE F F F\nPOINTS 99999999999\nDATA binary\n"),
              HasSubstr("the file ends after 0"));
  EXPECT_THAT(refusal(folder, "# .PCD v0.7\nFIELDS x y\nSIZE 4 4\nTYPE F F\nPOINTS 1\nDATA ascii\n1 2\n"),
              HasSubstr("no z"));
}

TEST(Pcd, WarnsOfWhatIsNotApplied) {
  const TemporaryFolder folder;
  const std::vector<Row> rows = some_rows(4);
  folder.write("a.pcd", header(4, "ascii", "VIEWPOINT 0 0 0 1 0 0 0\n") + ascii_body(rows));
  EXPECT_TRUE(open_pcd(folder / "a.pcd")->info().warnings.empty());
  folder.write("a.pcd", header(4, "ascii", "VIEWPOINT 0 0 1.5 1 0 0 0\n") + ascii_body(rows));
  EXPECT_THAT(open_pcd(folder / "a.pcd")->info().warnings,
              ElementsAre(HasSubstr("'VIEWPOINT 0 0 1.5 1 0 0 0' is not applied")));
  folder.write("a.pcd",
               "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\nHEIGHT 2\nDATA ascii\n0 0 0\n1 0 0\n2 0 0\n3 0 nan\n");
  const auto organised = open_reader(folder / "a.pcd");
  EXPECT_EQ(organised->info().count, 4u);
  EXPECT_THAT(organised->info().warnings, ElementsAre(HasSubstr("2 rows of 2")));
}

TEST(Pcd, RealFilesHaveThePointsAndBoundsOfTheirInventory) {
  if (data_folder().empty()) GTEST_SKIP() << "the folder of real clouds is absent; set POINTSWEEP_DATA to it";
  struct Known {
    const char* file;
    std::uint64_t count;
    double low_x, high_z;
  };
  for (const Known& known :
       {Known{"models/pcl_chef/chef.pcd", 5092, -0.111101, -0.588471}, Known{"malformed/pcl/octants.pcd", 8, -9, -3},
        Known{"malformed/pdal/pcd/utm17_tab.pcd", 10, 289814.15, 170.76}}) {
    const auto reader = open_reader(data_folder() / known.file);
    ASSERT_EQ(reader->info().count, known.count) << known.file;
    const Schema& schema = reader->info().schema;
    const PositionFields p = position_fields(schema, known.file);
    const auto x = values_of(*reader, p.x.name), z = values_of(*reader, p.z.name);
    EXPECT_NEAR(*std::ranges::min_element(x), known.low_x, 1e-6 * std::abs(known.low_x) + 0.02 * (known.low_x > 1e5));
    EXPECT_NEAR(*std::ranges::max_element(z), known.high_z, 1e-5 * std::abs(known.high_z));
  }
}

}  // namespace
}  // namespace pointsweep
