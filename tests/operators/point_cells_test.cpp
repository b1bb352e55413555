// SPDX-License-Identifier: MIT
#include "pointsweep/operators/nearest/point_cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <mutex>
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
  cells.nearest_of_all(places, {.k = k, .most2 = most2}, [&](std::size_t i, const std::vector<CellNeighbor>& found) {
    all[i].clear();
    for (const CellNeighbor& n : found)
      all[i].emplace_back(n.distance2, n.position.x, n.position.y, n.position.z, n.row);
  });
  return all;
}

/// Returns for each place the least squared distance to a point; an empty list if no point is within most2.
std::vector<std::vector<double>> distances(PointCells& cells, const std::vector<Vec3>& places, double most2) {
  std::vector<std::vector<double>> all(places.size());
  const NearestWanted any{.most2 = most2, .any_of_equal = true};
  cells.nearest_of_all(places, any, [&](std::size_t i, const std::vector<CellNeighbor>& found) {
    all[i].clear();
    for (const CellNeighbor& n : found) all[i].push_back(n.distance2);
  });
  return all;
}

void expect_nearest(const std::vector<Vec3>& points, const std::vector<Vec3>& places, std::size_t k, double most2) {
  for (const auto space : {PointCells::Space::plane, PointCells::Space::all}) {
    std::vector<std::vector<Key>> all_expected;
    for (const Vec3& place : places) all_expected.push_back(nearest_by_brute_force(points, space, place, k, most2));
    for (const int axis : {0, 1}) {
      PointCells cells = cells_of(points, space, axis);
      const std::vector<std::vector<Key>> found = nearest(cells, places, k, most2);
      const std::vector<std::vector<double>> least = distances(cells, places, most2);
      for (std::size_t i = 0; i < places.size(); ++i) {
        const std::vector<Key>& expected = all_expected[i];
        ASSERT_EQ(found[i], expected) << i << ", axis " << axis;
        ASSERT_EQ(least[i].size(), std::min<std::size_t>(1, expected.size())) << i;
        if (!expected.empty()) {
          ASSERT_EQ(least[i][0], std::get<0>(expected[0])) << i;
        }
      }
    }
  }
}

/// There are several times as many cells as memory holds. Places lie all over the cloud and outside of it.
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

Vec3 on_sphere(Vec3 p) { return (1 / length(p - Vec3{0.5, 0.5, 0.5})) * (p - Vec3{0.5, 0.5, 0.5}); }

std::vector<Vec3> moved(std::vector<Vec3> points, double scale, Vec3 by) {
  for (Vec3& p : points) p = scale * p + by;
  return points;
}

/// More places than one group holds. All points are almost equally far from a place.
TEST(PointCells, FindTheNearestOfPlacesFarAwayAndInTheMiddle) {
  std::vector<Vec3> points = random_points(1600, {1, 1, 1}, 8);
  std::ranges::transform(points, points.begin(), on_sphere);
  const std::vector<Vec3> places = moved(random_points(1100, {1, 1, 1}, 9), 1, {-0.5, -0.5, -0.5});
  for (const Vec3 far :
       {Vec3{100, 0, 0}, Vec3{0, -3, 0}, Vec3{7, 7, 1e6}, Vec3{1e9, 1e9, -1e9}, Vec3{1e12, -3e11, 2e11}})
    expect_nearest(points, moved(places, 1, far), 2, kAny);
  for (const double scale : {0.0, 1e-12, 0.01, 1.0}) expect_nearest(points, moved(places, scale, {}), 2, kAny);
  expect_nearest(points, moved(places, 1, {3, 0, 0}), 3, 7);  // some places find a few points, some none
  expect_nearest(moved(points, 1e-160, {}), moved(places, 1e-160, {}), 2, kAny);
}

TEST(PointCells, FindTheNearestOfManyPlacesAmongFewPointsAndOfFewAmongMany) {
  const std::vector<Vec3> many = random_points(3000, {10, 4, 1}, 10);
  for (const std::size_t few : {1u, 2u, 9u, 200u}) {
    const std::vector<Vec3> some = random_points(few, {10, 4, 1}, 11);
    expect_nearest(some, many, 4, kAny);
    expect_nearest(many, some, 4, kAny);
    expect_nearest(some, many, 30, 1);
  }
  std::vector<Vec3> copies;
  for (const Vec3 p : random_points(50, {10, 4, 1}, 12)) copies.insert(copies.end(), 100, p);
  expect_nearest(copies, many, 3, kAny);
  expect_nearest(many, copies, 3, kAny);
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
        corners.size(), 7, [&](std::size_t i) { return corners[i]; },
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

/// Compares the points within a radius of each place with a loop over all points.
void expect_within(const std::vector<Vec3>& points, const std::vector<Vec3>& places, double radius) {
  for (const auto space : {PointCells::Space::plane, PointCells::Space::all})
    for (const int axis : {0, 1}) {
      PointCells cells = cells_of(points, space, axis);
      std::vector<std::vector<Key>> found(places.size());
      std::vector<std::size_t> times(places.size());
      std::mutex mutex;
      cells.nearest_within(places, radius, [&](const PointCells::WithinPlaces& within) {
        const std::lock_guard lock(mutex);
        std::size_t at = 0;
        for (std::size_t p = 0; p < within.places.size(); ++p) {
          ++times[within.places[p]];
          for (std::size_t j = 0; j < within.counts[p]; ++j, ++at) {
            const CellNeighbor& n = within.neighbors[at];
            found[within.places[p]].emplace_back(n.distance2, n.position.x, n.position.y, n.position.z, n.row);
          }
        }
        EXPECT_EQ(at, within.neighbors.size());
      });
      for (std::size_t i = 0; i < places.size(); ++i) {
        const auto expected = nearest_by_brute_force(points, space, places[i], points.size(), radius * radius);
        ASSERT_EQ(found[i], expected) << i << ", axis " << axis << ", radius " << radius;
        ASSERT_EQ(times[i], 1u) << i;
      }
    }
}

TEST(PointCells, GiveAllPointsWithinADistance) {
  const std::vector<Vec3> points = random_points(60'000, {100, 40, 5}, 13);
  std::vector<Vec3> places = random_points(150, {100, 40, 5}, 14);
  places.push_back({500, 20, 0});
  expect_within(points, places, 0.7);
  expect_within(points, {places.begin(), places.begin() + 3}, 1000);
  std::vector<Vec3> grid;
  for (int i = 0; i < 2000; ++i) grid.push_back({double(i % 10), double(i / 10 % 10), double(i / 100 % 10)});
  std::vector<Vec3> corners;
  for (std::size_t i = 0; i < grid.size(); i += 7) corners.push_back(grid[i]);
  for (const double radius : {0.0, 1.0, std::sqrt(2.0), std::sqrt(3.0), 2.0}) expect_within(grid, corners, radius);
  expect_within({}, places, 3);
  expect_within({{1, 1, 1}}, {{1, 1, 1}, {1, 1, 2}}, 1);
  expect_within(moved(grid, 1e-170, {}), moved(places, 1e-170, {}), 1e-200);
  expect_within(moved(grid, 0.1, {684000.1, 5403000.3, 0}), moved(corners, 0.1, {684000.1, 5403000.3, 0}), 0.1);
}

}  // namespace
}  // namespace pointsweep
