// SPDX-License-Identifier: MIT
#include "pointsweep/operators/surface/curvature.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "pointsweep/operators/surface/normals.h"
#include "tests/operators/analytic_surface.h"
#include "tests/support/brute_force.h"
#include "tests/support/in_core.h"

namespace pointsweep {
namespace {

using Float3 = std::array<float, 3>;
using Lists = std::vector<std::vector<std::uint32_t>>;
using Points = std::vector<AnalyticPoint>;

enum Made { kK1, kK2, kDirection, kMean, kGaussian, kRms, kAbsolute, kVariation, kEigenvalues };

InCoreResult curvature_of(const std::vector<Vec3>& points, const Lists& lists, const Column& normals,
                          std::size_t cell_points = kCellCapacity) {
  return InCoreCloud(points, lists, cell_points)
      .apply(Curvature(), std::vector<Column>{normals}, std::vector<Column>{normals});
}

Points sphere(double radius = 2) {
  AnalyticSurface s(1);
  return AnalyticSurface::draw(2000, [&] { return s.sphere(radius); });
}
Points cylinder() {
  AnalyticSurface s(2);
  return AnalyticSurface::draw(2000, [&] { return s.cylinder(0.5, 4); });
}
Points torus() {
  AnalyticSurface s(3);
  return AnalyticSurface::draw(2000, [&] { return s.torus(0.4); });
}

/// Mean errors relative to the true curvature. Errors of k2 are relative to k1, since k2 may be 0.
struct Errors {
  double k1_bias = 0, k2_bias = 0, k1 = 0, k2 = 0, mean_bias = 0, angle = 0;
  std::size_t points = 0;
};

template <class Keep>
Errors errors(const Points& truth, std::size_t k, bool true_normals, Keep keep) {
  const std::vector<Vec3> points = positions_of(truth);
  const Lists lists = brute_force_neighbors(points, k);
  const Column normals = true_normals ? normals_of(truth) : InCoreCloud(points, lists).apply(Normals()).columns[0];
  const InCoreResult found = curvature_of(points, lists, normals);
  EXPECT_EQ(found.degenerate, 0u);
  const auto k1 = found.column<float>(kK1), k2 = found.column<float>(kK2), mean = found.column<float>(kMean);
  const auto direction = found.column<Float3>(kDirection);
  Errors e;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (!keep(truth[i])) continue;
    const double e1 = k1[i] / truth[i].k1 - 1, e2 = (k2[i] - truth[i].k2) / truth[i].k1;
    e.k1_bias += e1, e.k2_bias += e2, e.k1 += std::abs(e1), e.k2 += std::abs(e2);
    e.mean_bias += mean[i] / ((truth[i].k1 + truth[i].k2) / 2) - 1;
    e.angle += line_angle(wide(direction[i]), truth[i].k1_direction);
    ++e.points;
  }
  for (double* sum : {&e.k1_bias, &e.k2_bias, &e.k1, &e.k2, &e.mean_bias, &e.angle}) *sum /= double(e.points);
  return e;
}

const auto kAll = [](const AnalyticPoint&) { return true; };
const auto kOffTheEnds = [](const AnalyticPoint& p) { return p.position.z > 0.4 && p.position.z < 3.6; };

TEST(Curvature, OfASphereIsOneOverItsRadius) {
  for (const std::size_t k : {8u, 24u}) {
    const Errors e = errors(sphere(), k, true, kAll);
    EXPECT_LE(e.k1, 1e-3) << k;
    EXPECT_LE(e.k2, 1e-3) << k;
  }
}

TEST(Curvature, OfACylinderIsOneOverItsRadiusAroundAndZeroAlong) {
  for (const std::size_t k : {8u, 24u}) {
    const Errors e = errors(cylinder(), k, true, kAll);
    EXPECT_LE(e.k1, 2e-3) << k;
    EXPECT_LE(e.k2, 1e-3) << k;
    EXPECT_LE(e.angle, 1e-3) << k;
  }
}

TEST(Curvature, OfATorusIsThatOfItsTubeAndOfItsRing) {
  const Errors few = errors(torus(), 8, true, kAll), more = errors(torus(), 24, true, kAll);
  EXPECT_LE(few.k1, 0.06);
  EXPECT_LE(few.k2, 0.06);
  EXPECT_LE(std::abs(few.mean_bias), 0.04);
  EXPECT_LE(more.k1, 0.03);
  EXPECT_LE(more.k2, 0.03);
  EXPECT_LE(std::abs(more.mean_bias), 0.02);
  EXPECT_LE(more.angle, 0.1);
}

TEST(Curvature, FromEstimatedNormalsIsRightToAFewPerCentOnAverage) {
  for (const std::size_t k : {16u, 32u}) {
    SCOPED_TRACE(k);
    const Errors ball = errors(sphere(), k, false, kAll), pipe = errors(cylinder(), k, false, kOffTheEnds),
                 ring = errors(torus(), k, false, kAll);
    EXPECT_LE(std::abs(ball.k1_bias), 0.06);
    EXPECT_LE(std::abs(ball.mean_bias), 0.1);
    EXPECT_LE(std::abs(pipe.k1_bias), 0.06);
    EXPECT_LE(pipe.k2, 0.15);
    EXPECT_LE(std::abs(ring.k1_bias), 0.06);
    EXPECT_LE(pipe.angle, 0.25);
  }
}

TEST(Curvature, OfAPlaneIsZeroWithSomeTangentAsDirection) {
  AnalyticSurface s(4);
  const Points plane = AnalyticSurface::draw(500, [&] { return s.plane(); });
  const std::vector<Vec3> points = positions_of(plane);
  const InCoreResult found = curvature_of(points, brute_force_neighbors(points, 8), normals_of(plane));
  EXPECT_EQ(found.degenerate, 0u);
  for (const std::size_t m : {kK1, kK2, kMean, kGaussian, kRms, kAbsolute, kVariation})
    for (const float v : found.column<float>(m)) EXPECT_EQ(v, 0);
  for (const Float3 d : found.column<Float3>(kDirection)) {
    EXPECT_NEAR(length(wide(d)), 1, 1e-6);
    EXPECT_EQ(d[2], 0);
  }
}

TEST(Curvature, CombinationsFollowFromThePrincipalOnes) {
  const Points truth = torus();
  const std::vector<Vec3> points = positions_of(truth);
  const InCoreResult found = curvature_of(points, brute_force_neighbors(points, 8), normals_of(truth));
  const auto k1 = found.column<float>(kK1), k2 = found.column<float>(kK2);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double a = k1[i], b = k2[i], close = 1e-6 * (a + b + a * b);
    EXPECT_GE(a, b);
    EXPECT_GE(b, 0);
    EXPECT_NEAR(found.column<float>(kMean)[i], (a + b) / 2, close);
    EXPECT_NEAR(found.column<float>(kGaussian)[i], a * b, close);
    EXPECT_NEAR(found.column<float>(kRms)[i], std::sqrt((a * a + b * b) / 2), close);
    EXPECT_NEAR(found.column<float>(kAbsolute)[i], a + b, close);
    if (i > 200) break;
  }
}

/// Equation 2 in long double with Eigen's solver. k1 and k2 use equal weights.
struct Equation2 {
  double k1, k2, variation;
  std::array<double, 3> eigenvalues;

  Equation2(const std::vector<Vec3>& points, const std::vector<Float3>& normals, std::size_t i,
            const std::vector<std::uint32_t>& neighbors) {
    using Real = long double;
    using Vector = Eigen::Matrix<Real, 3, 1>;
    using Matrix = Eigen::Matrix<Real, 3, 3>;
    const auto normal = [&](std::size_t j) {
      return Vector(normals[j][0], normals[j][1], normals[j][2]).normalized().eval();
    };
    const auto offset = [&](std::uint32_t j) {
      return Vector(Real(points[j].x) - points[i].x, Real(points[j].y) - points[i].y, Real(points[j].z) - points[i].z);
    };
    Real farthest2 = 0;
    for (const std::uint32_t j : neighbors) farthest2 = std::max(farthest2, offset(j).squaredNorm());
    const Real sigma2 = std::numbers::pi_v<Real> * farthest2 / Real(neighbors.size());
    const auto theta = [&](std::uint32_t j) { return std::exp(-offset(j).squaredNorm() / (2 * sigma2)); };
    Vector mean = Vector::Zero();
    for (const std::uint32_t j : neighbors) mean += offset(j) / Real(neighbors.size());
    Matrix c = Matrix::Zero(), equal = c, p = c, m = c;
    for (const std::uint32_t j : neighbors) {
      c += theta(j) * normal(j) * normal(j).transpose() / Real(neighbors.size());
      equal += normal(j) * normal(j).transpose();
      p += (offset(j) - mean) * (offset(j) - mean).transpose();
      m += theta(j) * offset(j) * offset(j).transpose();
    }
    const Vector paper = Eigen::SelfAdjointEigenSolver<Matrix>(c).eigenvalues();
    eigenvalues = {double(paper(0)), double(paper(1)), double(paper(2))};
    const Eigen::SelfAdjointEigenSolver<Matrix> solver(equal), spread(m);
    const Vector n = normal(i), v1 = solver.eigenvectors().col(1), v2 = solver.eigenvectors().col(0);
    const bool first = std::abs(v1.dot(n)) <= std::abs(v2.dot(n));
    const Vector along = first ? (v1 - v1.dot(n) * n).normalized() : v2.cross(n).normalized(), across = n.cross(along);
    const Real a = std::sqrt(std::max<Real>(solver.eigenvalues()(1), 0) / along.dot(p * along));
    const Real b = std::sqrt(std::max<Real>(solver.eigenvalues()(0), 0) / across.dot(p * across));
    k1 = double(std::max(a, b)), k2 = double(std::min(a, b));
    variation = double(spread.eigenvalues()(0) / spread.eigenvalues().sum());
  }
};

void expect_equation2(const std::vector<Vec3>& points, const Lists& lists, const Column& normals) {
  const InCoreResult found = curvature_of(points, lists, normals);
  const auto k1 = found.column<float>(kK1), k2 = found.column<float>(kK2), v = found.column<float>(kVariation);
  const auto eigenvalues = found.column<Float3>(kEigenvalues);
  const auto normal_of_points = InCoreResult{.columns = {normals}, .degenerate = 0}.column<Float3>(0);
  for (std::size_t i = 0; i < 500; ++i) {
    const Equation2 truth(points, normal_of_points, i, lists[i]);
    EXPECT_NEAR(k1[i], truth.k1, 1e-5 * truth.k1) << i;
    EXPECT_NEAR(k2[i], truth.k2, 1e-5 * truth.k1) << i;
    EXPECT_NEAR(v[i], truth.variation, 3e-7 * truth.variation + 1e-12) << i;
    for (std::size_t e = 0; e < 3; ++e)
      EXPECT_NEAR(eigenvalues[i][e], truth.eigenvalues[e], 1e-6 * truth.eigenvalues[e] + 1e-14) << i;
  }
}

TEST(Curvature, EqualsEquation2WithNormalsOfTheSameNeighborhoodsAndOthersSideBySide) {
  const Points surface = torus();
  const std::vector<Vec3> points = positions_of(surface);
  const Column exact = normals_of(surface);
  for (const std::size_t k : {5u, 8u, 30u}) {
    SCOPED_TRACE(k);
    const Lists lists = brute_force_neighbors(points, k);
    const Column estimated = InCoreCloud(points, lists).apply(Normals()).columns[0];
    Column mixed = estimated;
    for (std::size_t i = 0; i < points.size(); i += 3)
      std::copy_n(exact.begin() + std::ptrdiff_t(i * sizeof(Float3)), sizeof(Float3),
                  mixed.begin() + std::ptrdiff_t(i * sizeof(Float3)));
    expect_equation2(points, lists, estimated);
    expect_equation2(points, lists, mixed);
  }
}

TEST(Curvature, EqualsEquation2WhereNeighborsLieOnThePoint) {
  Points surface = torus();
  for (std::size_t i = 0; i + 1 < surface.size(); i += 3) surface[i + 1].position = surface[i].position;
  const std::vector<Vec3> points = positions_of(surface);
  for (const std::size_t k : {5u, 8u, 30u}) {
    SCOPED_TRACE(k);
    expect_equation2(points, brute_force_neighbors(points, k), normals_of(surface));
  }
}

TEST(Curvature, DoesNotSeeTheSignsOfNormals) {
  const Points truth = torus();
  const std::vector<Vec3> points = positions_of(truth);
  Points flipped = truth;
  for (std::size_t i = 0; i < flipped.size(); i += 1 + i % 3) flipped[i].normal = -1 * flipped[i].normal;
  const Lists lists = brute_force_neighbors(points, 8);
  EXPECT_EQ(curvature_of(points, lists, normals_of(truth)).columns,
            curvature_of(points, lists, normals_of(flipped)).columns);
}

TEST(Curvature, DoesNotDependOnWhatSharesTheBatch) {
  const Points truth = torus();
  const std::vector<Vec3> points = positions_of(truth);
  const Lists lists = brute_force_neighbors(points, 8);
  const InCoreResult whole = curvature_of(points, lists, normals_of(truth));
  for (const std::size_t cell : {1u, 7u, 1000u})
    EXPECT_EQ(curvature_of(points, lists, normals_of(truth), cell).columns, whole.columns);
}

TEST(Curvature, ShrinksAsTheCloudGrowsByPowersOfTwo) {
  const Points truth = torus();
  const std::vector<Vec3> points = positions_of(truth);
  const Lists lists = brute_force_neighbors(points, 8);
  const InCoreResult before = curvature_of(points, lists, normals_of(truth));
  for (const double s : {0x1p-30, 0x1p40}) {
    std::vector<Vec3> scaled;
    for (const Vec3 p : points) scaled.push_back(s * p);
    const InCoreResult after = curvature_of(scaled, lists, normals_of(truth));
    for (std::size_t i = 0; i < points.size(); ++i)
      ASSERT_EQ(after.column<float>(kK1)[i], float(before.column<float>(kK1)[i] / s));
    EXPECT_EQ(after.columns[kDirection], before.columns[kDirection]);
    EXPECT_EQ(after.columns[kVariation], before.columns[kVariation]);
  }
}

TEST(Curvature, StaysFiniteAtAnyScale) {
  const Points truth = AnalyticSurface::draw(200, [s = AnalyticSurface(5)]() mutable { return s.torus(0.4); });
  for (const double s : {1e-200, 1e-100, 1e100, 1e200}) {
    std::vector<Vec3> scaled;
    for (const AnalyticPoint& p : truth) scaled.push_back(s * p.position);
    const Lists lists = brute_force_neighbors(positions_of(truth), 8);
    const InCoreResult found = curvature_of(scaled, lists, normals_of(truth));
    EXPECT_EQ(found.degenerate, 0u);
    for (const std::size_t m : {kK1, kK2, kMean, kGaussian, kRms, kAbsolute})
      for (const float v : found.column<float>(m)) EXPECT_TRUE(std::isfinite(v)) << s;
  }
}

TEST(Curvature, IsZeroAndCountedWhereNormalsOrNeighborsAreMissing) {
  Points truth = sphere();
  truth.resize(30);
  const std::vector<Vec3> points = positions_of(truth);
  const Lists lists = brute_force_neighbors(points, 8);
  const auto zeros = [&](const Lists& neighbors, const Points& p) {
    const InCoreResult found = curvature_of(positions_of(p), neighbors, normals_of(p));
    for (const Column& made : found.columns)
      for (std::size_t b = 0; b < made.size() / p.size(); ++b) EXPECT_EQ(made[b], std::byte{0});
    return found.degenerate;
  };
  Points none = truth;
  none[0].normal = {};
  EXPECT_EQ(zeros(lists, none), 1u) << "no normal";
  none[0].normal = {NAN, 0, 1};
  EXPECT_EQ(zeros(lists, none), 1u) << "no number";
  Lists two = lists;
  two[0].resize(2);
  EXPECT_EQ(zeros(two, truth), 1u) << "two neighbours";
  none = truth;
  for (std::size_t j = 0; j < 6; ++j) none[lists[0][j]].normal = {};
  Lists only_first(truth.size());
  only_first[0] = lists[0];
  EXPECT_EQ(zeros(only_first, none), truth.size()) << "two neighbours with a normal, and points without neighbours";
  Points line = truth;
  for (std::size_t i = 0; i < line.size(); ++i) line[i].position = {0.1 * double(i), 0.2 * double(i), 0};
  EXPECT_EQ(zeros(brute_force_neighbors(positions_of(line), 8), line), line.size()) << "on a line";
  Points same = truth;
  for (AnalyticPoint& p : same) p.position = {1, 2, 3};
  EXPECT_EQ(zeros(brute_force_neighbors(positions_of(same), 8), same), same.size()) << "all equal";
}

}  // namespace
}  // namespace pointsweep
