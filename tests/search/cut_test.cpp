// SPDX-License-Identifier: MIT
#include "pointsweep/search/cut.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "pointsweep/neighborhood.h"
#include "pointsweep/search/cell.h"
#include "tests/support/instruction_sets.h"

namespace pointsweep {
namespace {

std::uint64_t row_of(std::uint32_t index) { return 1'000'000 - index; }

/// Returns points of a kind: 0: a noisy sheet; 1: a cube; 2: a regular grid with many ties; 3: a line; 4: one place; 5:
/// very different scales.
std::vector<CutPoint> points_of(int kind, std::size_t n) {
  std::mt19937_64 rng(7 * n + static_cast<std::size_t>(kind));
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::vector<CutPoint> points;
  for (std::uint32_t i = 0; i < n; ++i) {
    const float x = uniform(rng), y = uniform(rng), z = uniform(rng);
    CutPoint p{{x, y, z}, i};
    if (kind == 0) p.c = {x, y, 0.1F * x * y + 1e-3F * z};
    if (kind == 2) p.c = {static_cast<float>(i % 7), static_cast<float>(i / 7 % 7), static_cast<float>(i / 49)};
    if (kind == 3) p.c = {5, x, 5};
    if (kind == 4) p.c = {1, 2, 3};
    if (kind == 5) p.c = {x * 1e-20F, y * 1e20F, z};
    points.push_back(p);
  }
  std::shuffle(points.begin(), points.end(), rng);
  return points;
}

std::vector<std::uint32_t> indices(const std::vector<CutPoint>& points) {
  std::vector<std::uint32_t> result;
  for (const CutPoint& p : points) result.push_back(p.index);
  return result;
}

/// Expects that the two halves are separated along the longest side of their box, up to the rounding of the keys, and
/// so are their halves.
void expect_halves(const CutPoint* points, std::size_t n) {
  if (n <= kLeafCapacity) return;
  std::size_t longest = 0;
  float extent = -1;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto [lo, hi] =
        std::minmax_element(points, points + n, [a](const CutPoint& p, const CutPoint& q) { return p.c[a] < q.c[a]; });
    if (hi->c[a] - lo->c[a] > extent) longest = a, extent = hi->c[a] - lo->c[a];
  }
  const std::size_t left = (n / kLeafCapacity + 1) / 2 * kLeafCapacity;
  const auto before = [longest](const CutPoint& p, const CutPoint& q) { return p.c[longest] < q.c[longest]; };
  const float last = std::max_element(points, points + left, before)->c[longest];
  const float first = std::min_element(points + left, points + n, before)->c[longest];
  ASSERT_LE(last, first + extent * 1e-5F);
  expect_halves(points, left);
  expect_halves(points + left, n - left);
}

TEST(Cut, KeepsEveryPointInCellsThatAreNotTooLarge) {
  for (const int kind : {0, 1, 2, 3, 4, 5}) {
    for (const std::size_t n : {1, 15, 16, 17, 1000, 5000}) {
      for (const std::uint32_t cell_points : {16U, 64U, 1024U, 2048U}) {
        std::vector<CutPoint> points = points_of(kind, n);
        std::vector<std::uint32_t> begin;
        cut(points, cell_points, row_of, begin);
        ASSERT_EQ(begin.front(), 0U);
        ASSERT_EQ(begin.back(), n);
        for (std::size_t c = 0; c + 1 < begin.size(); ++c) {
          ASSERT_GT(begin[c + 1], begin[c]);
          ASSERT_LE(begin[c + 1] - begin[c], cell_points);
        }
        std::vector<std::uint32_t> all(n), left = indices(points);
        std::iota(all.begin(), all.end(), 0U);
        std::sort(left.begin(), left.end());
        ASSERT_EQ(left, all) << "kind " << kind << ", " << n << " points";
      }
    }
  }
}

TEST(LeafCut, HalvesAcrossTheLongestSide) {
  for (const int kind : {0, 1, 2, 3, 5}) {
    for (const std::size_t n : {17, 32, 33, 100, 1000, 2048}) {
      SCOPED_TRACE("kind " + std::to_string(kind) + ", " + std::to_string(n) + " points");
      std::vector<CutPoint> points = points_of(kind, n);
      cut_into_leaves(points, row_of);
      expect_halves(points.data(), n);
    }
  }
}

TEST(LeafCut, OrdersPointsAtOnePlaceByRow) {
  for (const std::size_t n : {0, 1, 2, 15, 16, 17, 500}) {
    std::vector<CutPoint> points = points_of(4, n);
    cut_into_leaves(points, row_of);
    const auto later = [](const CutPoint& p, const CutPoint& q) { return row_of(p.index) < row_of(q.index); };
    EXPECT_TRUE(std::is_sorted(points.begin(), points.end(), later)) << n;
  }
}

TEST(LeafCut, IsTheSameOnEveryInstructionSet) {
  for (const int kind : {0, 1, 2, 3, 4, 5}) {
    std::vector<CutPoint> reference = points_of(kind, 1500);
    cut_into_leaves(reference, row_of);
    for_each_instruction_set([&] {
      std::vector<CutPoint> points = points_of(kind, 1500);
      cut_into_leaves(points, row_of);
      EXPECT_EQ(indices(points), indices(reference)) << "kind " << kind;
    });
  }
}

}  // namespace
}  // namespace pointsweep
