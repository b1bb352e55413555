// SPDX-License-Identifier: MIT
#include "pointsweep/operators/point_cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <memory>
#include <random>
#include <tuple>
#include <vector>

#include "tests/support/scratch_in_memory.h"

namespace pointsweep {
namespace {

constexpr double kAny = std::numeric_limits<double>::infinity();

std::vector<Vec3> random_points(std::size_t n, Vec3 extent, unsigned seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  std::vector<Vec3> points(n);
  for (Vec3& p : points) p = {extent.x * uniform(), extent.y * uniform(), extent.z * uniform()};
  return points;
}

PointCells cells_of(const std::vector<Vec3>& points, PointCells::Space space, int axis) {
  PointCells cells(space, axis, 0, std::make_unique<ScratchInMemory>());
  std::vector<std::size_t> order(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::sort(order, {}, [&](std::size_t i) { return points[i][axis]; });
  for (const std::size_t i : order) cells.add(points[i], i);
  cells.finish();
  return cells;
}

using Key = std::tuple<double, double, double, double, std::uint64_t>;

std::vector<Key> nearest_by_brute_force(const std::vector<Vec3>& points, PointCells::Space space, Vec3 place,
                                        std::size_t k, double most2) {
  std::vector<Key> keys;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double x = points[i].x - place.x, y = points[i].y - place.y, z = points[i].z - place.z;
    const double d2 = space == PointCells::Space::plane ? x * x + y * y : (x * x + y * y) + z * z;
    if (d2 <= most2) keys.emplace_back(d2, points[i].x, points[i].y, points[i].z, i);
  }
  k = std::min(k, keys.size());
  std::ranges::partial_sort(keys, keys.begin() + static_cast<std::ptrdiff_t>(k));
  keys.resize(k);
  return keys;
}

std::vector<std::vector<Key>> nearest(PointCells& cells, const std::vector<Vec3>& places, std::size_t k, double most2) {
  std::vector<std::vector<Key>> all(places.size());
  const auto place = [&](std::size_t i) { return places[i]; };
  cells.answer_all(places.size(), place, [&](std::size_t i, PointCells::View& view) {
    const auto* const found = view.nearest(places[i], k, most2);
    if (found == nullptr) return false;
    for (const CellNeighbor& n : *found)
      all[i].emplace_back(n.distance2, n.position.x, n.position.y, n.position.z, n.row);
    return true;
  });
  return all;
}

void expect_nearest(const std::vector<Vec3>& points, const std::vector<Vec3>& places, std::size_t k, double most2) {
  for (const auto space : {PointCells::Space::plane, PointCells::Space::all}) {
    for (const int axis : {0, 1}) {
      PointCells cells = cells_of(points, space, axis);
      const std::vector<std::vector<Key>> found = nearest(cells, places, k, most2);
      for (std::size_t i = 0; i < places.size(); ++i)
        ASSERT_EQ(found[i], nearest_by_brute_force(points, space, places[i], k, most2)) << i << ", axis " << axis;
    }
  }
}

/// Several times as many cells as are in memory; questions from all over and from outside.
TEST(PointCells, FindTheNearestInAnyOrderOfQuestions) {
  const std::vector<Vec3> points = random_points(150'000, {100, 40, 5}, 1);
  std::vector<Vec3> places = random_points(40, {100, 40, 5}, 2);
  for (const Vec3 outside : {Vec3{-500, 20, 0}, Vec3{700, 20, 0}, Vec3{50, 900, 0}, Vec3{50, 20, -800}})
    places.push_back(outside);
  expect_nearest(points, places, 5, kAny);
}

TEST(PointCells, QuestionsThatFollowOneAnotherAreAnsweredTogether) {
  std::vector<Vec3> points = random_points(60'000, {100, 10, 1}, 3);
  std::erase_if(points, [](Vec3 p) { return p.x > 30 && p.x < 70; });  // a hole many cells wide
  std::vector<Vec3> places = random_points(200, {100, 10, 1}, 4);
  std::ranges::sort(places, {}, &Vec3::x);
  expect_nearest(points, places, 3, kAny);
}

TEST(PointCells, EqualDistancesGoByPositionAndRowAndDistancesHaveALimit) {
  std::vector<Vec3> points;
  for (int i = 0; i < 6000; ++i) points.push_back({double(i % 10), double(i / 10 % 10), double(i / 100 % 10)});
  const std::vector<Vec3> places = {{5, 5, 5}, {0, 0, 0}, {4.5, 4.5, 4.5}, {20, 5, 5}};
  expect_nearest(points, places, 40, kAny);
  expect_nearest(points, places, 40, 1);
  expect_nearest(points, places, 40, 0.5);
  expect_nearest(points, {{1, 2, 3}}, 1, 0);
}

TEST(PointCells, AreRightForFewPointsOnePlaceAndNone) {
  expect_nearest({}, {{1, 2, 3}}, 4, kAny);
  expect_nearest({{1, 1, 1}}, {{1, 2, 3}, {1, 1, 1}}, 4, kAny);
  expect_nearest(std::vector<Vec3>(70'000, Vec3{1, 2, 3}), {{1, 2, 3}, {0, 0, 0}}, 3, kAny);
}

TEST(PointCells, GiveAllPointsOfABox) {
  const std::vector<Vec3> points = random_points(100'000, {100, 40, 5}, 6);
  const std::vector<Vec3> corners = random_points(60, {100, 40, 5}, 7);
  for (const int axis : {0, 1}) {
    PointCells cells = cells_of(points, PointCells::Space::all, axis);
    std::vector<std::vector<std::uint64_t>> rows(corners.size());
    const auto box = [&](std::size_t i) { return Box{corners[i], corners[i] + Vec3{3, 2, double(i % 4)}}; };
    cells.answer_all(
        corners.size(), [&](std::size_t i) { return corners[i]; },
        [&](std::size_t i, PointCells::View& view) {
          rows[i].clear();
          return view.within(box(i), [&](const CellPoint& p) { rows[i].push_back(p.row); });
        });
    for (std::size_t i = 0; i < corners.size(); ++i) {
      std::vector<std::uint64_t> expected;
      const Box b = box(i);
      for (std::size_t j = 0; j < points.size(); ++j) {
        const Vec3 p = points[j];
        if (p.x >= b.lo.x && p.x <= b.hi.x && p.y >= b.lo.y && p.y <= b.hi.y && p.z >= b.lo.z && p.z <= b.hi.z)
          expected.push_back(j);
      }
      std::ranges::sort(rows[i]);
      EXPECT_EQ(rows[i], expected);
    }
  }
}

}  // namespace
}  // namespace pointsweep
