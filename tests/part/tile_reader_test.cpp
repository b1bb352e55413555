// SPDX-License-Identifier: MIT
/// Points with non-finite coordinates of a stored tile, read in parts, whole and damaged.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "pointsweep/error.h"
#include "pointsweep/part/tile_catalogue.h"
#include "tests/support/memory_storage.h"
#include "tests/sweep/swept_cloud.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kNonfinite = 2 * kNonfiniteAtOnce + 100;

class StoredTile : public testing::Test {
 protected:
  StoredTile() {
    std::vector<Vec3> points(kNonfinite + 10, Vec3{std::numeric_limits<double>::quiet_NaN(), 0, 0});
    for (std::size_t i = 0; i < points.size(); ++i) points[i].y = static_cast<double>(i);
    for (std::size_t i = 0; i < 10; ++i) points[7 * i] = {static_cast<double>(i), 1, 2};
    const PointSource source = source_of(points);
    StreamOptions order;
    order.canonical = false;
    const Survey surveyed = survey(source, std::nullopt, true);
    const Stream stream(source, surveyed, order);
    index_ = store_tile(stream, surveyed, points.size(), scratch_, "tile");
    catalogue_ = catalogue_of(scratch_, {"tile"}, {"tile"});
  }

  std::vector<std::byte> read(std::uint64_t first, std::uint64_t count) {
    TileReader reader(scratch_, catalogue_, index_.record_bytes);
    std::vector<std::byte> records(count * index_.record_bytes);
    reader.read_nonfinite(0, first, records);
    return records;
  }

  MemoryStorage scratch_;
  TileIndex index_;
  TileCatalogue catalogue_;
};

TEST_F(StoredTile, GivesAnyPartOfItsNonfinitePoints) {
  ASSERT_EQ(index_.nonfinite, kNonfinite);
  const std::vector<std::byte> all = read(0, kNonfinite);
  double y = 0;
  std::memcpy(&y, all.data() + 8, sizeof y);
  EXPECT_EQ(y, 1);  // point 0 has a place
  for (const auto& [first, count] : {std::pair<std::uint64_t, std::uint64_t>{0, 1},
                                     {kNonfiniteAtOnce - 1, 2},
                                     {kNonfiniteAtOnce, kNonfiniteAtOnce},
                                     {100, 2 * kNonfiniteAtOnce},
                                     {kNonfinite - 1, 1},
                                     {kNonfinite, 0}}) {
    const auto begin = all.begin() + static_cast<std::ptrdiff_t>(first * index_.record_bytes);
    EXPECT_EQ(read(first, count),
              std::vector<std::byte>(begin, begin + static_cast<std::ptrdiff_t>(count * index_.record_bytes)))
        << first << " " << count;
  }
}

TEST_F(StoredTile, RefusesDamageInWhateverPartItIsRead) {
  const std::unique_ptr<Source> stored = scratch_.open("tile.points");
  std::vector<std::byte> bytes(stored->size());
  stored->read_at(0, bytes);
  bytes[bytes.size() - 50 * index_.record_bytes] ^= std::byte{1};  // in the last piece
  const std::unique_ptr<Unsealed> damaged = scratch_.create("tile.points");
  damaged->write_at(0, bytes);
  damaged->seal();
  EXPECT_NO_THROW(read(0, 2 * kNonfiniteAtOnce));
  EXPECT_THROW(read(0, kNonfinite), Error);
  EXPECT_THROW(read(kNonfinite - 1, 1), Error);
  EXPECT_THROW(read(kNonfiniteAtOnce, kNonfiniteAtOnce + 1), Error);
}

TEST_F(StoredTile, OfAnotherRunIsRefusedEveryTime) {
  TileReader reader(scratch_, catalogue_, index_.record_bytes + 8);
  for (int time = 0; time < 2; ++time) EXPECT_THROW(reader.index(0), Error);
}

TEST(TileGroups, HoldEachTileWithPointsOnceAndFewPoints) {
  TileCatalogue tiles;
  for (std::uint32_t t = 0; t < 1000; ++t) {
    const Vec3 corner{double(t % 40), double(t / 40), 0};
    const std::uint64_t points = t % 7 == 0 ? 0 : t % 11 == 0 ? 100'000 : 3000;
    tiles.tiles.push_back({std::to_string(t), 0, points, {}});
    if (points > 0) tiles.tiles.back().regions.push_back({0, 1, points, {corner, corner + Vec3{1, 1, 1}}, 0});
  }
  tiles = decoded<TileCatalogue>(encoded(std::as_const(tiles)));
  std::vector<int> times(1000);
  for (const TileGroup& group : tiles.groups) {
    std::uint64_t points = 0;
    for (const std::uint32_t t : group.tiles) {
      ++times[t];
      points += tiles.tiles[t].rows;
      EXPECT_EQ(distance2(group.box, tiles.tiles[t].regions[0].box.center()), 0);
    }
    EXPECT_EQ(group.count, points);
    EXPECT_TRUE(group.tiles.size() == 1 || (points <= 65'536 && group.tiles.size() <= 32));
    EXPECT_LT(group.box.diagonal(), 12);
  }
  for (std::uint32_t t = 0; t < 1000; ++t) EXPECT_EQ(times[t], t % 7 == 0 ? 0 : 1);
  EXPECT_LT(tiles.groups.size(), 500u);
}

}  // namespace
}  // namespace pointsweep
