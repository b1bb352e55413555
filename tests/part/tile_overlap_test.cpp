// SPDX-License-Identifier: MIT
/// The mean number of tiles in which a point lies.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "pointsweep/part/tile_catalogue.h"

namespace pointsweep {
namespace {

Box square(double x, double y, double size) { return {{x, y, 0}, {x + size, y + size, 10}}; }

TEST(TileOverlap, IsOneOfTilesSideBySide) {
  const std::vector<TileExtent> tiles = {{square(0, 0, 5), 10}, {square(5, 0, 5), 70}, {square(0, 5, 5), 1}, {{}, 0}};
  EXPECT_DOUBLE_EQ(mean_tiles_of_a_point(tiles), 1);
  EXPECT_DOUBLE_EQ(mean_tiles_of_a_point({}), 1);
}

TEST(TileOverlap, CountsTheTilesOfEachPoint) {
  // All 100 points of the small square lie in both, and a quarter of the 300 of the large one.
  const std::vector<TileExtent> two = {{square(0, 0, 10), 300}, {square(5, 5, 5), 100}};
  EXPECT_DOUBLE_EQ(mean_tiles_of_a_point(two), (300 * 1.25 + 100 * 2) / 400);
  const std::vector<TileExtent> same(7, {square(-3, 2, 4), 50});
  EXPECT_DOUBLE_EQ(mean_tiles_of_a_point(same), 7);
}

TEST(TileOverlap, TakesFlatBoxesAndBoxesOfOnePoint) {
  const Box flat{{0, 0, 3}, {10, 10, 3}}, point{{2, 2, 3}, {2, 2, 3}}, above{{0, 0, 4}, {10, 10, 4}};
  const std::vector<TileExtent> tiles = {{flat, 8}, {point, 2}, {above, 10}};
  EXPECT_DOUBLE_EQ(mean_tiles_of_a_point(tiles), (8 * 1 + 2 * 2 + 10 * 1) / 20.0);
}

TEST(TileOverlap, LeavesOutBoxesThatAreNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<TileExtent> tiles = {{square(0, 0, 5), 10}, {{{nan, 0, 0}, {nan, 1, 1}}, 1000}};
  EXPECT_DOUBLE_EQ(mean_tiles_of_a_point(tiles), 1);
}

}  // namespace
}  // namespace pointsweep
