// SPDX-License-Identifier: MIT
#include "pointsweep/verify/search/nearest_in_stream.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/pipeline/hostile_clouds.h"
#include "tests/support/brute_force.h"

namespace pointsweep {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

std::vector<std::uint32_t> rows_of(const std::vector<NearPoint>& found) {
  std::vector<std::uint32_t> rows;
  for (const NearPoint& p : found) rows.push_back(static_cast<std::uint32_t>(p.row));
  return rows;
}

/// Returns about 100 places, far from the points and among them.
std::vector<Vec3> places_for(const std::vector<Vec3>& points) {
  std::vector<Vec3> places{{0, 0, 0}, {-1e9, 3, 7}, {1e-300, -1e-300, 0}};
  for (std::size_t i = 0; i < points.size(); i += points.size() / 100)
    if (is_finite(points[i])) places.push_back(points[i]);
  return places;
}

TEST(NearestInStream, IsBruteForceOnEveryHostileCloud) {
  for (const auto& [name, shape] : hostile_shapes()) {
    std::vector<Vec3> points = make_cloud(shape, 2000, 5);
    const std::vector<Vec3> places = places_for(points);
    for (const std::size_t most : {std::size_t{1}, std::size_t{9}, std::size_t{3000}}) {
      NearestInStream nearest(places, std::vector<double>(places.size(), kInf), most);
      for (std::size_t i = points.size(); i-- > 0;) nearest.offer(points[i], i);
      for (std::size_t i = 0; i < places.size(); ++i) {
        points.push_back(places[i]);  // the oracle excludes the query point itself
        const auto expected = brute_force_neighbors_of(points, std::uint32_t(points.size() - 1), most, kInf);
        points.pop_back();
        ASSERT_EQ(rows_of(nearest.nearest(i)), expected) << name << ", place " << i << ", most " << most;
      }
    }
  }
}

TEST(NearestInStream, KeepsAllWithinTheReachAndThoseOnItsEdge) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes()[4].second, 2000, 6);  // a grid
  const std::vector<Vec3> places{{0, 0, 0}, {5, 5, 5}, {20, 0, 0}};
  NearestInStream nearest(places, {4, 9, 81}, NearestInStream::kAll);
  for (std::size_t i = 0; i < points.size(); ++i) nearest.offer(points[i], i);
  const double reach2[] = {4, 9, 81};
  for (std::size_t p = 0; p < places.size(); ++p) {
    std::size_t within = 0;
    for (const Vec3& q : points) within += distance2(q, places[p]) <= reach2[p];
    EXPECT_GT(within, 0u);
    EXPECT_EQ(nearest.nearest(p).size(), within);
  }
}

TEST(NearestInStream, ATightReachChangesNothing) {
  for (const auto& [name, shape] : hostile_shapes()) {
    const std::vector<Vec3> points = make_cloud(shape, 1000, 7);
    const std::vector<Vec3> places = places_for(points);
    NearestInStream wide(places, std::vector<double>(places.size(), kInf), 5);
    for (std::size_t i = 0; i < points.size(); ++i) wide.offer(points[i], i);
    std::vector<double> reach2;
    for (std::size_t p = 0; p < places.size(); ++p) reach2.push_back(wide.reach2(p));
    NearestInStream tight(places, reach2, 5);
    for (std::size_t i = 0; i < points.size(); ++i) tight.offer(points[i], i);
    for (std::size_t p = 0; p < places.size(); ++p)
      ASSERT_EQ(rows_of(tight.nearest(p)), rows_of(wide.nearest(p))) << name << ", place " << p;
  }
}

TEST(NearestInStream, CoordinatesAtTheEndsOfTheNumbersAreNoHarm) {
  const std::vector<Vec3> points{{1e308, 0, 0},  {-1e308, 0, 0}, {1e12, 1e12, 1e12}, {1e12 + 1e-3, 1e12, 1e12},
                                 {1e-320, 0, 0}, {0, 1e-310, 0}, {0, 0, 0},          {1e-12, 0, 0}};
  NearestInStream nearest(points, std::vector<double>(points.size(), kInf), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) nearest.offer(points[i], i);
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    std::vector<std::uint32_t> found = rows_of(nearest.nearest(i));
    std::erase(found, i);
    EXPECT_EQ(found, brute_force_neighbors_of(points, i, points.size(), kInf)) << i;
  }
}

}  // namespace
}  // namespace pointsweep
