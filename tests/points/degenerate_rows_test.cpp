// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "pointsweep/points/degenerate_points.h"

namespace pointsweep {
namespace {

using Rows = std::vector<std::uint64_t>;

TEST(DegeneratePoints, AreGivenOnceEachInAscendingOrder) {
  DegeneratePoints points;
  EXPECT_EQ(points.count(), 0u);
  for (const std::size_t i : {700u, 64u, 0u, 63u, 700u, 2047u, 64u}) points.mark(i);
  std::vector<std::size_t> marked;
  points.for_each([&](std::size_t i) { marked.push_back(i); });
  EXPECT_EQ(marked, (std::vector<std::size_t>{0, 63, 64, 700, 2047}));
  EXPECT_EQ(points.count(), 5u);
}

TEST(DegenerateRows, AreAllListedUpToAThousand) {
  DegenerateRows rows;
  for (std::uint64_t row = 1000; row > 0; --row) rows.add(7 * row);
  EXPECT_EQ(rows.count(), 1000u);
  EXPECT_EQ(rows.lowest().size(), 1000u);
  EXPECT_EQ(rows.lowest().front(), 7u);
  rows.add(6999);
  EXPECT_EQ(rows.count(), 1001u);
  EXPECT_EQ(rows.lowest().size(), 1000u);
  EXPECT_EQ(rows.lowest().back(), 6999u) << "7000 has made place";
  rows.add(8000);
  EXPECT_EQ(rows.lowest().back(), 6999u);
}

TEST(DegenerateRows, DependNeitherOnOrderNorOnWhoAddedThem) {
  Rows all(5000);
  std::iota(all.begin(), all.end(), 3u);
  const Rows lowest(all.begin(), all.begin() + 1000);
  std::mt19937 rng(8);
  for (int trial = 0; trial < 5; ++trial) {
    std::ranges::shuffle(all, rng);
    std::vector<DegenerateRows> parts(4), sum;
    for (const std::uint64_t row : all) parts[rng() % parts.size()].add(row);
    for (const DegenerateRows& part : parts) add_rows(sum, {{}, DegenerateRows(part.count(), part.lowest())});
    ASSERT_EQ(sum.size(), 2u);
    EXPECT_EQ(sum[0].count(), 0u);
    EXPECT_EQ(sum[1].count(), 5000u);
    EXPECT_EQ(sum[1].lowest(), lowest);
  }
}

}  // namespace
}  // namespace pointsweep
