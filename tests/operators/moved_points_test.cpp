// SPDX-License-Identifier: MIT
/// Operators after an operator that moves points. The neighbour lists are in the order of the search, which no longer
/// is that of the distances. Each operator is compared with its formula in long double over N_i as a set.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "pointsweep/operators.h"
#include "pointsweep/operators/statistics/neighbor_rows.h"
#include "pointsweep/operators/surface/curvature.h"
#include "pointsweep/operators/surface/fair.h"
#include "pointsweep/operators/surface/normals.h"
#include "pointsweep/operators/surface/splats.h"
#include "tests/operators/analytic_surface.h"
#include "tests/support/brute_force.h"
#include "tests/support/in_core.h"
#include "tests/support/instruction_sets.h"

namespace pointsweep {
namespace {

using Float3 = std::array<float, 3>;
using Lists = std::vector<std::vector<std::uint32_t>>;
using Real = long double;
using Vector = Eigen::Matrix<Real, 3, 1>;
using Matrix = Eigen::Matrix<Real, 3, 3>;
using Solver = Eigen::SelfAdjointEigenSolver<Matrix>;

/// A cloud after a move: the moved points, and their neighbours before the move.
struct MovedCloud {
  std::string name;
  std::vector<Vec3> points;
  Lists lists;

  InCoreResult apply(const LocalOperator& op, const std::vector<Column>& reads = {},
                     const std::vector<Column>& near = {}, std::size_t cell_points = kCellCapacity) const {
    return InCoreCloud(points, lists, cell_points, true).apply(op, reads, near);
  }
  Vector offset(std::size_t i, std::uint32_t j) const {
    return {Real(points[j].x) - points[i].x, Real(points[j].y) - points[i].y, Real(points[j].z) - points[i].z};
  }
};

std::vector<Vec3> noisy_torus(std::size_t n) {
  AnalyticSurface surface(31);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < n; ++i)
    points.push_back(surface.torus(0.4).position + surface.gaussian(0.01) * Vec3{1, 1, 1});
  return points;
}

/// Returns the points smoothed so much that near and far neighbours change places.
std::vector<Vec3> faired(const std::vector<Vec3>& points, const Lists& lists) {
  const InCoreCloud cloud(points, lists);
  const Column normals = cloud.apply(Normals()).columns[0];
  const InCoreResult splats = cloud.apply(Splats(), std::vector<Column>{normals});
  const std::vector<Column> reads{splats.columns[1], splats.columns[2]}, near{normals, reads[0], reads[1]};
  std::vector<Vec3> moved;
  for (const auto& p : cloud.apply(Fair({.f = 0.4, .g = 0.4}), reads, near).column<std::array<double, 3>>(0))
    moved.push_back({p[0], p[1], p[2]});
  return moved;
}

/// Rounds points to a grid so coarse that many neighbours, first or last in a list, coincide with their point.
std::vector<Vec3> snapped(std::vector<Vec3> points) {
  for (Vec3& p : points) p = {0.125 * std::round(8 * p.x), 0.125 * std::round(8 * p.y), 0.125 * std::round(8 * p.z)};
  return points;
}

/// Returns the points inverted about a place near the cloud, so that far points become near points.
std::vector<Vec3> inverted(std::vector<Vec3> points) {
  const Vec3 center{1.05, 0.02, 0.03};
  for (Vec3& p : points) p = center + (1 / dot(p - center, p - center)) * (p - center);
  return points;
}

/// Moves every point to the place of another point.
std::vector<Vec3> shuffled(std::vector<Vec3> points) {
  std::mt19937_64 random(5);
  std::shuffle(points.begin(), points.end(), random);
  return points;
}

std::vector<MovedCloud> moved_clouds(std::size_t k, double radius = std::numeric_limits<double>::infinity()) {
  const std::vector<Vec3> points = noisy_torus(1200);
  const Lists lists = brute_force_neighbors(points, k, radius);
  return {{"fair", faired(points, lists), lists},
          {"grid", snapped(points), lists},
          {"inversion", inverted(points), lists},
          {"shuffle", shuffled(points), lists}};
}

struct Sizes {
  Real farthest2 = 0;
  std::size_t nearest_place = 0, farthest_place = 0;

  Sizes(const MovedCloud& cloud, std::size_t i) {
    Real nearest2 = std::numeric_limits<Real>::infinity();
    for (std::size_t j = 0; j < cloud.lists[i].size(); ++j) {
      const Real d2 = cloud.offset(i, cloud.lists[i][j]).squaredNorm();
      if (d2 > farthest2) farthest2 = d2, farthest_place = j;
      if (d2 > 0 && d2 < nearest2) nearest2 = d2, nearest_place = j;
    }
  }
};

/// θ of Equation 1 and the two sums over it.
struct Sums {
  Matrix m = Matrix::Zero(), c = Matrix::Zero();

  Sums(const MovedCloud& cloud, std::size_t i, const std::vector<Vector>& normals) {
    const Real n = Real(cloud.lists[i].size());
    const Real sigma2 = std::numbers::pi_v<Real> * Sizes(cloud, i).farthest2 / n;
    for (const std::uint32_t j : cloud.lists[i]) {
      const Vector o = cloud.offset(i, j);
      const Real theta = sigma2 > 0 ? std::exp(-o.squaredNorm() / (2 * sigma2)) : 1;
      m += theta / n * o * o.transpose();
      if (!normals.empty()) c += theta / n * normals[j] * normals[j].transpose();
    }
  }
};

std::vector<Vector> unit_vectors(const std::vector<Float3>& normals) {
  std::vector<Vector> units;
  for (const Float3& n : normals) {
    const Vector v(n[0], n[1], n[2]);
    units.push_back(v.norm() > 0 ? (v / v.norm()).eval() : v);
  }
  return units;
}

Vec3 narrowed(const Vector& v) { return {double(v(0)), double(v(1)), double(v(2))}; }

/// Returns normals of a stage before the move. Any normals do; these are normals of a sphere.
Column some_normals(std::size_t n) {
  AnalyticSurface surface(77);
  std::vector<Float3> normals;
  for (std::size_t i = 0; i < n; ++i) normals.push_back(narrow(surface.sphere(1).normal));
  return column_of(normals);
}

void for_each_neighborhood(const std::function<void(const MovedCloud&)>& expect) {
  for (const std::size_t k : {2u, 5u, 8u, 16u, 30u, 64u, 200u})
    for (const MovedCloud& cloud : moved_clouds(k)) {
      SCOPED_TRACE(cloud.name + ", k = " + std::to_string(k));
      expect(cloud);
    }
  for (const MovedCloud& cloud : moved_clouds(1000, 0.3)) {
    SCOPED_TRACE(cloud.name + ", within a radius");
    expect(cloud);
  }
}

TEST(MovedPoints, TheirListsAreNotInTheOrderOfDistances) {
  for (const MovedCloud& cloud : moved_clouds(16)) {
    std::size_t last = 0, first = 0;
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      const Sizes sizes(cloud, i);
      last += sizes.farthest_place == cloud.lists[i].size() - 1, first += sizes.nearest_place == 0;
    }
    EXPECT_LT(last, cloud.points.size() * 9 / 10) << cloud.name;
    EXPECT_LT(first, cloud.points.size() * 98 / 100) << cloud.name;
  }
}

TEST(MovedPoints, TheirNormalsEqualEquation1) {
  for_each_neighborhood([](const MovedCloud& cloud) {
    const auto found = cloud.apply(Normals()).column<Float3>(0);
    std::size_t compared = 0, flat = 0;
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      const Solver e(Sums(cloud, i, {}).m);
      const Real l0 = e.eigenvalues()(0), l1 = e.eigenvalues()(1), l2 = e.eigenvalues()(2);
      if (!(l2 > 0) || l1 < 1e-9L * l2) {
        flat += found[i] == Float3{};
        continue;
      }
      if ((l1 - l0) / l2 < 1e-8L) continue;
      ++compared;
      ASSERT_NEAR(length(wide(found[i])), 1, 1e-6) << i;
      ASSERT_LE(line_angle(wide(found[i]), narrowed(e.eigenvectors().col(0))), 2e-7 + 1e-7 * double(l1 / (l1 - l0)))
          << i;
    }
    EXPECT_GE(compared + flat, cloud.points.size() * (cloud.lists[0].size() < 6 ? 2 : 9) / 10);
  });
}

TEST(MovedPoints, TheirNeighborRadiusIsThatOfTheFarthest) {
  for_each_neighborhood([](const MovedCloud& cloud) {
    const InCoreResult found =
        cloud.apply(*std::get<std::shared_ptr<const LocalOperator>>(operators::neighborhood_size()));
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      ASSERT_EQ(found.column<std::uint32_t>(0)[i], cloud.lists[i].size());
      ASSERT_NEAR(found.column<double>(1)[i], double(std::sqrt(Sizes(cloud, i).farthest2)), 1e-14) << i;
      if (i > 300) break;
    }
  });
}

TEST(MovedPoints, TheirCurvaturesEqualEquation2) {
  for_each_neighborhood([](const MovedCloud& cloud) {
    const Column normals = some_normals(cloud.points.size());
    const std::vector<Vector> units = unit_vectors(InCoreResult{{normals}}.column<Float3>(0));
    const InCoreResult found = cloud.apply(Curvature(), {normals}, {normals});
    const auto k1 = found.column<float>(0), variation = found.column<float>(7);
    const auto eigenvalues = found.column<Float3>(8);
    std::size_t compared = 0;
    for (std::size_t i = 0; i < cloud.points.size(); i += 3) {
      const Sums sums(cloud, i, units);
      const Vector m = Solver(sums.m).eigenvalues(), c = Solver(sums.c).eigenvalues();
      if (!(m(1) > 1e-9L * m(2)) || cloud.lists[i].size() < 3 || eigenvalues[i] == Float3{}) continue;
      ++compared;
      ASSERT_NEAR(variation[i], double(m(0) / m.sum()), 3e-7 * double(m(0) / m.sum()) + 1e-7) << i;
      for (int e = 0; e < 3; ++e) ASSERT_NEAR(eigenvalues[i][std::size_t(e)], double(c(e)), 1e-6 * double(c(2))) << i;
    }
    EXPECT_GE(compared, cloud.lists[0].size() < 6 ? 0 : cloud.points.size() / 3 * 8 / 10);
  });
}

/// Returns the major semi-axis of a splat: eight neighbours lie inside, in the metric of the ellipse. Returns 0 without
/// a neighbour at a distance.
Real splat_length(const MovedCloud& cloud, std::size_t i, const Vector& normal, const Vector& axis, Real ratio) {
  const Vector across = normal.cross(axis);
  std::vector<Real> reach2;
  for (const std::uint32_t j : cloud.lists[i]) {
    const Real a = cloud.offset(i, j).dot(axis), b = cloud.offset(i, j).dot(across) / ratio;
    if (a * a + b * b > 0) reach2.push_back(a * a + b * b);
  }
  if (reach2.empty()) return 0;
  std::sort(reach2.begin(), reach2.end());
  const std::size_t held = std::min<std::size_t>(8, reach2.size());
  return std::sqrt(reach2[held - 1] * 8 / Real(held));
}

TEST(MovedPoints, TheirSplatsHaveTheRatioOfM_iAndHoldEightNeighbors) {
  for_each_neighborhood([](const MovedCloud& cloud) {
    const Column normals = cloud.apply(Normals()).columns[0];
    const std::vector<Vector> units = unit_vectors(InCoreResult{{normals}}.column<Float3>(0));
    const InCoreResult found = cloud.apply(Splats(), {normals});
    const auto axes = found.column<Float3>(0);
    const auto length = found.column<float>(1), ratio = found.column<float>(2);
    std::size_t compared = 0;
    for (std::size_t i = 0; i < cloud.points.size(); i += 2) {
      const Vector l = Solver(Sums(cloud, i, {}).m).eigenvalues();
      if (units[i].norm() == 0 || length[i] == 0 || (l(2) - l(1)) / l(2) < 1e-3L) continue;
      ++compared;
      const Real flatness = std::clamp<Real>(std::sqrt(l(1) / l(2)), 0.125L, 1);
      ASSERT_NEAR(ratio[i], double(flatness), 2e-6) << i;
      const Vector axis = unit_vectors({axes[i]})[0];
      const Real expected = splat_length(cloud, i, units[i], axis, Real(ratio[i]));
      ASSERT_NEAR(length[i], double(expected), 1e-5 * double(expected)) << i;
    }
    EXPECT_GE(compared, cloud.points.size() * (cloud.lists[0].size() < 6 ? 1 : 3) / 10);
  });
}

TEST(MovedPoints, TheirNeighborsAreWrittenNearestFirstWhereTheyAreNow) {
  for_each_neighborhood([](const MovedCloud& cloud) {
    const std::size_t n = cloud.points.size(), k = 12;
    const InCoreResult found = cloud.apply(NeighborRows(k, n, true));
    const auto rows = found.column<std::uint32_t>(0);
    const auto distances = found.column<double>(1);
    for (std::size_t i = 0; i < n; ++i) {
      std::vector<std::uint32_t> expected = cloud.lists[i];
      const auto key = [&](std::uint32_t j) {
        const Vec3 p = cloud.points[j];
        return std::tuple(distance2(p, cloud.points[i]), p.x, p.y, p.z, j);
      };
      std::sort(expected.begin(), expected.end(), [&](auto a, auto b) { return key(a) < key(b); });
      for (std::size_t j = 0; j < k; ++j) {
        const bool there = j < expected.size();
        ASSERT_EQ(rows[i * k + j], there ? expected[j] : std::numeric_limits<std::uint32_t>::max()) << i;
        if (there) {
          ASSERT_EQ(distances[i * k + j], std::sqrt(distance2(cloud.points[expected[j]], cloud.points[i])));
        }
      }
    }
  });
}

std::vector<Column> all_columns(const MovedCloud& cloud, std::size_t cell_points = kCellCapacity) {
  const Column normals = some_normals(cloud.points.size());
  std::vector<Column> made = cloud.apply(Normals(), {}, {}, cell_points).columns;
  for (const InCoreResult& result :
       {cloud.apply(Curvature(), {normals}, {normals}, cell_points), cloud.apply(Splats(), {normals}, {}, cell_points)})
    made.insert(made.end(), result.columns.begin(), result.columns.end());
  return made;
}

/// Returns a cloud with neighbourhoods of 0 to 150 points, in which ordinary and extreme extents stand side by side.
MovedCloud mixed_cloud() {
  MovedCloud cloud = moved_clouds(150)[1];
  const std::size_t counts[] = {8, 8, 0, 1, 2, 9, 64, 7, 150, 16, 33};
  for (std::size_t i = 0; i < cloud.lists.size(); ++i) cloud.lists[i].resize(counts[i % std::size(counts)]);
  for (std::size_t i = 5; i < cloud.points.size(); i += 40) cloud.points[i] = 1e-170 * cloud.points[i];
  for (std::size_t i = 7; i < cloud.points.size(); i += 90) cloud.points[i] = 1e170 * cloud.points[i];
  cloud.points[11] = {1.7e308, -1.7e308, 0};
  cloud.points[13].y = std::numeric_limits<double>::quiet_NaN();
  cloud.points[17].z = std::numeric_limits<double>::infinity();
  return cloud;
}

TEST(MovedPoints, TheirBytesDependNeitherOnTheBatchNorOnTheInstructionSet) {
  const MovedCloud cloud = mixed_cloud();
  const std::vector<Column> whole = all_columns(cloud);
  for_each_instruction_set([&] {
    EXPECT_EQ(all_columns(cloud), whole);
    for (const std::size_t cell : {1u, 3u, 17u, 100u}) EXPECT_EQ(all_columns(cloud, cell), whole) << cell;
  });
}

using Rows = std::vector<std::uint64_t>;

/// Returns the rows whose values are all 0.
Rows zero_rows(const InCoreResult& result, std::size_t points) {
  Rows rows;
  for (std::uint64_t i = 0; i < points; ++i) {
    const bool zero = std::ranges::all_of(result.columns, [&](const Column& made) {
      const auto width = static_cast<std::ptrdiff_t>(made.size() / points);
      const auto value = made.begin() + static_cast<std::ptrdiff_t>(i) * width;
      return std::all_of(value, value + width, [](std::byte b) { return b == std::byte{0}; });
    });
    if (zero) rows.push_back(i);
  }
  return rows;
}

TEST(MovedPoints, WithoutAResultAreMarkedOneByOneWhateverTheBatchAndTheInstructionSet) {
  const MovedCloud cloud = mixed_cloud();
  const std::size_t n = cloud.points.size();
  const Column normals = some_normals(n);
  const auto each = [&](std::size_t cell) {
    return std::vector<InCoreResult>{cloud.apply(Normals(), {}, {}, cell),
                                     cloud.apply(Curvature(), {normals}, {normals}, cell),
                                     cloud.apply(Splats(), {normals}, {}, cell)};
  };
  for_each_instruction_set([&] {
    for (const std::size_t cell : {std::size_t{1}, std::size_t{3}, std::size_t{17}, std::size_t{kCellCapacity}}) {
      for (const InCoreResult& result : each(cell)) {
        EXPECT_EQ(result.degenerate_rows, zero_rows(result, n)) << cell;
        EXPECT_GT(result.degenerate_rows.size(), 20u);
      }
    }
  });
}

TEST(MovedPoints, NextToAPlaceThatIsNotFiniteNothingIsDefined) {
  MovedCloud cloud = moved_clouds(8)[0];
  const std::uint32_t lost = cloud.lists[0][3];
  cloud.points[lost].y = std::numeric_limits<double>::quiet_NaN();
  const Column normals = some_normals(cloud.points.size());
  for (const InCoreResult& result :
       {cloud.apply(Normals()), cloud.apply(Curvature(), {normals}, {normals}), cloud.apply(Splats(), {normals})}) {
    EXPECT_GT(result.degenerate, 4u);
    for (const Column& made : result.columns)
      for (const std::size_t i : {std::size_t{0}, std::size_t{lost}})
        for (std::size_t b = 0, width = made.size() / cloud.points.size(); b < width; ++b)
          ASSERT_EQ(made[i * width + b], std::byte{0});
  }
  EXPECT_TRUE(std::isnan(cloud.apply(*std::get<std::shared_ptr<const LocalOperator>>(operators::neighborhood_size()))
                             .column<double>(1)[0]));
  const auto rows = cloud.apply(NeighborRows(8, cloud.points.size(), false)).column<std::uint32_t>(0);
  EXPECT_EQ(rows[7], lost);
}

TEST(MovedPoints, ByNothingKeepTheBytesOfThoseThatDidNotMove) {
  MovedCloud cloud{"none", noisy_torus(900), {}};
  for (const std::size_t k : {3u, 8u, 64u, 150u}) {
    cloud.lists = brute_force_neighbors(cloud.points, k);
    const Column normals = some_normals(cloud.points.size());
    const InCoreCloud still(cloud.points, cloud.lists);
    EXPECT_EQ(cloud.apply(Normals()).columns, still.apply(Normals()).columns) << k;
    EXPECT_EQ(cloud.apply(Curvature(), {normals}, {normals}).columns,
              still.apply(Curvature(), std::vector<Column>{normals}, std::vector<Column>{normals}).columns)
        << k;
    EXPECT_EQ(cloud.apply(Splats(), {normals}).columns, still.apply(Splats(), std::vector<Column>{normals}).columns)
        << k;
  }
}

}  // namespace
}  // namespace pointsweep
