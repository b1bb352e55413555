// SPDX-License-Identifier: MIT
/// Damaged encodings of the values that tasks store for each other.
#include <gtest/gtest.h>

#include <utility>

#include "pointsweep/error.h"
#include "pointsweep/part/tile.h"
#include "pointsweep/part/tile_catalogue.h"
#include "tests/storage/written_bytes.h"

namespace pointsweep {
namespace {

const Box kUnit{{0, 0, 0}, {1, 1, 1}};

template <class T>
void expect_survives_damage_of(const T& value) {
  const std::vector<std::byte> bytes = encoded(value);
  const auto again = [](std::span<const std::byte> damaged) { return encoded<const T>(decoded<T>(damaged)); };
  EXPECT_EQ(hex(again(bytes)), hex(bytes));
  expect_survives_damage(bytes, again);
}

TEST(TileEncodings, AnIndexSurvivesDamage) {
  TileIndex index;
  index.layout = "x:f64,y:f64,z:f64,row:u64";
  index.record_bytes = 32;
  index.rows = 700;
  index.nonfinite = 100;
  index.nonfinite_checksums = {5};
  index.survey.sample = {{0, 0, 0}, {1, 1, 1}};
  index.blocks = {{256, kUnit, 3, 17}, {244, kUnit, 0, 18}, {100, kUnit, 9, 19}};
  index.slab_ends = {2, 3};
  expect_survives_damage_of(index);
  index.blocks.push_back({7, kUnit, 4, 20});
  index.for_others = true;
  expect_survives_damage_of(index);
}

TEST(TileEncodings, ACatalogueSurvivesDamage) {
  expect_survives_damage_of(TileCatalogue{{{"a-0-0", 0, 1500, {{0, 2, 1300, kUnit, 0}, {2, 3, 100, kUnit, 9}}},
                                           {"b-0-1", 1500, 0, {}},
                                           {"c-0-2", 1500, 4, {{0, 1, 4, kUnit, 0}}}}});
}

TEST(TileEncodings, AnIndexOfOtherRowsThanItsBlocksHoldIsRefused) {
  TileIndex index;
  index.rows = 10;
  index.blocks = {{10, kUnit, 0, 0}};
  index.slab_ends = {1};
  EXPECT_NO_THROW(decoded<TileIndex>(encoded(std::as_const(index))));
  index.nonfinite = ~std::uint64_t{0};
  index.rows = 9;  // 10 + nonfinite, modulo 2^64
  EXPECT_THROW(decoded<TileIndex>(encoded(std::as_const(index))), Error);
  index.nonfinite = 0;
  EXPECT_THROW(decoded<TileIndex>(encoded(std::as_const(index))), Error);
}

}  // namespace
}  // namespace pointsweep
