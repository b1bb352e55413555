// SPDX-License-Identifier: MIT
/// The hierarchy of COPC files: boxes of chunks, and damaged hierarchies.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "pointsweep/error.h"
#include "pointsweep/formats/las/las_format.h"
#include "pointsweep/formats/las/las_reader.h"
#include "pointsweep/formats/las/laz_codec.h"
#include "pointsweep/points/schema.h"
#include "tests/formats/las_test_file.h"
#include "tests/formats/temporary_folder.h"
#include "tests/support/data_folder.h"

namespace pointsweep {
namespace {

using las_test::put;

constexpr std::size_t kPageEntry = 32;

/// Returns an entry of a hierarchy page in the layout of COPC 1.0.
std::string page_entry(std::int32_t level, std::int32_t x, std::int32_t y, std::int32_t z, std::uint64_t offset,
                       std::int32_t bytes, std::int32_t points) {
  std::string entry(kPageEntry, '\0');
  put(entry, 0, level), put(entry, 4, x), put(entry, 8, y), put(entry, 12, z);
  put(entry, 16, offset), put(entry, 24, bytes), put(entry, 28, points);
  return entry;
}

class Copc : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_codecs()) GTEST_SKIP() << "built without codecs";
    las_test::File file;
    file.minor = 4;
    file.format = 6;
    file.count = 2 * kLazChunkPoints + 1000;
    // Writers drop the info VLR of COPC, so the VLR gets its name after the file is written.
    file.vlrs = {las_test::vlr("cop_", 1, std::string(160, '\0'))};
    std::ofstream(folder_ / "a.las", std::ios::binary) << file.bytes();
    const auto reader = open_las(folder_ / "a.las");
    OutputPlan plan;
    plan.path = folder_ / "a.laz";
    plan.schema = reader->info().schema;
    plan.count = reader->info().count;
    plan.extras = reader->info().extras;
    std::vector<std::byte> records(plan.count * plan.schema.stride);
    ASSERT_EQ(reader->read(0, records), plan.count);
    const auto writer = create_laz_writer(plan);
    writer->write(records);
    writer->finish();
    bytes_ = contents(folder_ / "a.laz");
    const std::size_t name = bytes_.find("cop_");
    ASSERT_NE(name, std::string::npos);
    bytes_[name + 3] = 'c';
    info_ = name - 2 + 54;
    const auto laz = open_las(folder_ / "a.laz");
    for (std::uint64_t row = 0; row < plan.count; row = chunks_.back().end_row()) chunks_.push_back(laz->chunk_of(row));
    ASSERT_EQ(chunks_.size(), 3u);
    put(bytes_, info_ + 0, 100.0), put(bytes_, info_ + 8, 200.0), put(bytes_, info_ + 16, 300.0);
    put(bytes_, info_ + 24, 8.0);
  }

  std::string node(std::size_t chunk, std::int32_t level, std::int32_t x, std::int32_t y, std::int32_t z) const {
    const Chunk& c = chunks_[chunk];
    return page_entry(level, x, y, z, c.begin, static_cast<std::int32_t>(c.end - c.begin),
                      static_cast<std::int32_t>(c.rows));
  }

  /// Returns the file with the root page `page` at its end.
  std::string with_root(const std::string& page) const {
    std::string bytes = bytes_;
    put(bytes, info_ + 40, std::uint64_t{bytes.size()});
    put(bytes, info_ + 48, std::uint64_t{page.size()});
    return bytes + page;
  }

  std::unique_ptr<Reader> opened(const std::string& bytes) const {
    std::ofstream(folder_ / "c.copc.laz", std::ios::binary) << bytes;
    return open_las(folder_ / "c.copc.laz");
  }

  /// Expects that the points are read without the hierarchy, and that one warning gives the reason.
  void expect_ignored(const std::string& bytes, const std::string& reason) const {
    const auto reader = opened(bytes);
    EXPECT_FALSE(reader->chunk_of(0).bounds) << reason;
    std::vector<std::byte> record(reader->info().schema.stride);
    EXPECT_EQ(reader->read(kLazChunkPoints + 3, record), 1u);
    const auto& warnings = reader->info().warnings;
    EXPECT_EQ(std::ranges::count_if(warnings,
                                    [&](const std::string& w) {
                                      return w.find(": the hierarchy of the COPC file was ignored: ") !=
                                                 std::string::npos &&
                                             w.find(reason) != std::string::npos;
                                    }),
              1)
        << "expected: " << reason << "\ngot: " << (warnings.empty() ? "nothing" : warnings.back());
  }

  const TemporaryFolder folder_;
  std::string bytes_;
  std::size_t info_ = 0;  ///< offset of the content of the info VLR in the file
  std::vector<Chunk> chunks_;
};

TEST_F(Copc, ChunksHaveTheBoxesOfTheirNodes) {
  const std::string none = page_entry(1, 1, 1, 1, 0, 0, 0);
  const auto reader = opened(with_root(node(1, 1, 0, 1, 1) + none + node(0, 0, 0, 0, 0) + node(2, 3, 7, 0, 2)));
  for (const std::string& warning : reader->info().warnings)
    EXPECT_EQ(warning.find("hierarchy"), std::string::npos) << warning;
  const Box expected[] = {
      {{92, 192, 292}, {108, 208, 308}}, {{92, 200, 300}, {100, 208, 308}}, {{106, 192, 296}, {108, 194, 298}}};
  for (std::size_t c = 0; c < 3; ++c) {
    const Chunk chunk = reader->chunk_of(chunks_[c].first_row + 5);
    ASSERT_TRUE(chunk.bounds);
    EXPECT_EQ(*chunk.bounds, expected[c]) << c;
    EXPECT_EQ(chunk.first_row, chunks_[c].first_row);
  }
}

TEST_F(Copc, PagesNamePages) {
  // The file has a page of two nodes, then a page that refers to the first page, then the root page.
  const std::string leaves = node(1, 2, 0, 0, 1) + node(2, 2, 3, 3, 3);
  const std::uint64_t at = bytes_.size();
  const std::string between = page_entry(2, 0, 0, 1, at, static_cast<std::int32_t>(leaves.size()), -1);
  const std::string root =
      node(0, 0, 0, 0, 0) + page_entry(1, 0, 0, 0, at + leaves.size(), static_cast<std::int32_t>(kPageEntry), -1);
  std::string bytes = bytes_ + leaves + between;
  put(bytes, info_ + 40, std::uint64_t{bytes.size()});
  put(bytes, info_ + 48, std::uint64_t{root.size()});
  const auto reader = opened(bytes + root);
  ASSERT_TRUE(reader->chunk_of(kLazChunkPoints).bounds);
  EXPECT_EQ(*reader->chunk_of(kLazChunkPoints).bounds, (Box{{92, 192, 296}, {96, 196, 300}}));
}

TEST_F(Copc, AHierarchyThatContradictsTheFileIsIgnored) {
  const std::string first = node(0, 0, 0, 0, 0), second = node(1, 1, 0, 0, 0), third = node(2, 1, 1, 0, 0);
  const auto changed = [](std::string entry, std::size_t at, auto value) {
    put(entry, at, value);
    return entry;
  };
  expect_ignored(with_root(first + second), "it names no node for chunk 3 of 3");
  expect_ignored(with_root(first + second + third + node(1, 1, 1, 1, 1)), "chunk 2 belongs to two nodes");
  for (const std::int32_t points : {49'999, 50'001, std::numeric_limits<std::int32_t>::max(), -2})
    expect_ignored(with_root(first + changed(second, 28, points) + third), "node 1-0-0-0 is no chunk of the file");
  for (const std::int32_t bytes : {-1, 0, 17, std::numeric_limits<std::int32_t>::max()})
    expect_ignored(with_root(first + changed(second, 24, bytes) + third), "node 1-0-0-0 is no chunk of the file");
  for (const std::uint64_t offset : {std::uint64_t{0}, chunks_[1].begin + 1, ~std::uint64_t{0}})
    expect_ignored(with_root(first + changed(second, 16, offset) + third), "node 1-0-0-0 is no chunk of the file");
  for (const std::int32_t level : {-1, 32, 33, std::numeric_limits<std::int32_t>::max()})
    expect_ignored(with_root(first + changed(second, 0, level) + third), "there is no node");
  for (const std::size_t coordinate : {4, 8, 12})
    for (const std::int32_t place : {-1, 2, std::numeric_limits<std::int32_t>::min()})
      expect_ignored(with_root(first + changed(second, coordinate, place) + third), "there is no node 1-");
}

TEST_F(Copc, AHierarchyWhosePagesAreNotInTheFileOrLeadInCirclesIsIgnored) {
  const std::string all = node(0, 0, 0, 0, 0) + node(1, 1, 0, 0, 0) + node(2, 1, 1, 0, 0);
  const auto root_of = [&](std::uint64_t offset, std::uint64_t size) {
    std::string bytes = with_root(all);
    put(bytes, info_ + 40, offset);
    put(bytes, info_ + 48, size);
    return bytes;
  };
  const std::uint64_t end = bytes_.size() + all.size();
  for (const std::uint64_t size : {std::uint64_t{0}, std::uint64_t{33}, std::uint64_t{128}, ~std::uint64_t{31}})
    expect_ignored(root_of(bytes_.size(), size), "are no page of it");
  for (const std::uint64_t offset : {end, end + 1, ~std::uint64_t{0}, ~std::uint64_t{0} - 64})
    expect_ignored(root_of(offset, 96), "are no page of it");
  const auto page_at = [](std::uint64_t offset, std::int32_t bytes) {
    return page_entry(1, 0, 0, 0, offset, bytes, -1);
  };
  expect_ignored(with_root(all + page_at(bytes_.size(), 128)), "more than once");        // itself
  expect_ignored(with_root(all + page_at(~std::uint64_t{0}, 32)), "are no page of it");  // outside
  expect_ignored(with_root(all + page_at(bytes_.size(), -32)), "are no page of it");     // negative
  // Overlapping pages are refused once their bytes in all exceed those of the file.
  std::string many;
  for (std::uint64_t i = 0; i < 3000; ++i)
    many += page_at(i + 100'000, static_cast<std::int32_t>(bytes_.size() / 2 / 32 * 32));
  expect_ignored(with_root(many), "");
}

TEST_F(Copc, AnInfoWithoutASizeIsIgnored) {
  const std::string all = node(0, 0, 0, 0, 0) + node(1, 1, 0, 0, 0) + node(2, 1, 1, 0, 0);
  for (const double half : {0.0, -8.0, std::nan(""), std::numeric_limits<double>::infinity(), 1.7e308}) {
    std::string bytes = with_root(all);
    put(bytes, info_ + 24, half);
    expect_ignored(bytes, "its cube has no size");
  }
  std::string bytes = with_root(all);
  put(bytes, info_ + 8, std::nan(""));
  expect_ignored(bytes, "its cube has no size");
}

TEST(CopcData, PointsOfAChunkLieInTheBoxOfItsNode) {
  if (!std::filesystem::exists(data_folder() / "lidar")) GTEST_SKIP() << "no real data in " << data_folder();
  if (!has_codecs()) GTEST_SKIP() << "built without codecs";
  for (const char* name : {"lidar/laspy/simple_with_page.copc.laz", "lidar/pdal/copc/1.2-with-color.copc.laz",
                           "lidar/las-rs/autzen.copc.laz", "models/potree_lion/lion_takanawa.copc.laz"}) {
    SCOPED_TRACE(name);
    const auto reader = open_las(data_folder() / name);
    const FileInfo& info = reader->info();
    const PositionFields position = position_fields(info.schema, name);
    std::vector<std::byte> record(info.schema.stride);
    std::size_t chunks = 0;
    const Vec3 grid = {position.x.scale, position.y.scale, position.z.scale};
    for (std::uint64_t row = 0; row < info.count;) {
      const Chunk chunk = reader->chunk_of(row);
      ASSERT_TRUE(chunk.bounds) << row;
      ++chunks;
      for (; row < chunk.end_row(); ++row) {
        reader->read(row, record);
        const Vec3 p{value_of(position.x, record.data()), value_of(position.y, record.data()),
                     value_of(position.z, record.data())};
        for (int a = 0; a < 3; ++a) {
          ASSERT_GE(p[a], chunk.bounds->lo[a] - grid[a]);
          ASSERT_LE(p[a], chunk.bounds->hi[a] + grid[a]);
        }
      }
    }
    EXPECT_GE(chunks, 1u);
  }
}

TEST_F(Copc, TheWriterTellsHowManyPointsHaveReachedTheirNode) {
  const auto reader = open_las(folder_ / "a.las");
  std::vector<std::uint64_t> told;
  OutputPlan plan;
  plan.path = folder_ / "levels.copc.laz";
  plan.schema = reader->info().schema;
  plan.count = reader->info().count;
  plan.extras = reader->info().extras;
  plan.progress = [&](std::uint64_t points) { told.push_back(points); };
  std::vector<std::byte> records(plan.count * plan.schema.stride);
  ASSERT_EQ(reader->read(0, records), plan.count);
  const auto writer = create_copc_writer(plan);
  writer->write(records);
  EXPECT_EQ(told.size(), 0u);
  writer->finish();
  EXPECT_GE(told.size(), 3u);
  EXPECT_EQ(told.front(), 0u);
  EXPECT_TRUE(std::ranges::is_sorted(told));
  EXPECT_EQ(told.back(), plan.count);
}

}  // namespace
}  // namespace pointsweep
