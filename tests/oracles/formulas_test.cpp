// SPDX-License-Identifier: MIT
// The formulas of verify on neighbourhoods so small that their values can be calculated by hand.
#include <gtest/gtest.h>

#include <numbers>
#include <vector>

#include "pointsweep/verify/formulas/distances.h"
#include "pointsweep/verify/formulas/eigen.h"
#include "pointsweep/verify/formulas/surface.h"
#include "pointsweep/verify/formulas/weighted_neighbors.h"

namespace pointsweep::formulas {
namespace {

constexpr double kExact = 1e-15;
constexpr Real kPi = std::numbers::pi_v<Real>;

double near(Real a) { return static_cast<double>(a); }

const Place kOrigin{};
const std::vector<Place> kCross{{{1, 0, 0}}, {{0, 2, 0}}};
const Estimate kUp{.value = {0, 0, 1}};

/// Returns θ of Equation 1 at distance r for the neighbours of kCross: σ² = π 2² / 2.
Real theta(Real r) { return std::exp(-r * r / (2 * kPi * 4 / 2)); }

TEST(Formulas, EigenvaluesAscendAndVectorsAreTheirs) {
  Matrix m;
  m.add_outer_product(2, {1, 1, 0});  // 4 along (1, 1, 0)
  m.add_outer_product(3, {0, 0, 1});
  m.add_outer_product(0.5L, {1, -1, 0});  // 1 along (1, -1, 0)
  const Eigen e = eigen_of(m);
  EXPECT_NEAR(near(e.value[0]), 1, kExact);
  EXPECT_NEAR(near(e.value[1]), 3, kExact);
  EXPECT_NEAR(near(e.value[2]), 4, kExact);
  EXPECT_NEAR(near(std::fabs(dot(e.vector[2], {1, 1, 0}))), std::numbers::sqrt2, kExact);
}

TEST(Formulas, TheNormalOfACrossIsAcrossItAndPointsUp) {
  const Estimate n = normal(kOrigin, kCross, {});
  EXPECT_NEAR(near(n.value.z), 1, kExact);
  EXPECT_LT(near(n.error), 1e-7);
  EXPECT_FALSE(n.either_sign);
  const Estimate down = normal(kOrigin, kCross, {.side = Facing::Side::viewpoint, .viewpoint = {3, 3, -1}, .like = {}});
  EXPECT_NEAR(near(down.value.z), -1, kExact);
}

TEST(Formulas, APointOfALineHasNoNormal) {
  const std::vector<Place> line{{{1, 1, 1}}, {{2, 2, 2}}, {{-1, -1, -1}}};
  EXPECT_EQ(near(norm(normal(kOrigin, line, {}).value)), 0);
  EXPECT_EQ(near(norm(normal(kOrigin, std::vector<Place>{{{1, 0, 0}}}, {}).value)), 0);
}

TEST(Formulas, ASplatIsAsFlatAsTheRootOfTheEigenvalues) {
  const Splat s = splat(kOrigin, kUp, kCross, nullptr);
  const Real ratio = std::sqrt(theta(1) / (4 * theta(2)));
  EXPECT_NEAR(near(s.ratio.value.x), near(ratio), kExact);
  EXPECT_NEAR(near(std::fabs(s.axis.value.y)), 1, kExact);
  // Two neighbours, at 1 / ratio and 2 in the metric of the ellipse; eight would need four times the area.
  EXPECT_NEAR(near(s.length.value.x), near(2 * std::max<Real>(1 / ratio, 2)), kExact * 10);
}

TEST(Formulas, ASplatFromCurvatureLiesAcrossK1) {
  const CurvatureHere here{
      .k1 = {.value = {4, 0, 0}}, .k2 = {.value = {1, 0, 0}}, .k1_direction = {.value = {0, 1, 0}}};
  const Splat s = splat(kOrigin, kUp, kCross, &here);
  EXPECT_NEAR(near(s.ratio.value.x), 0.5, kExact);
  EXPECT_NEAR(near(std::fabs(s.axis.value.x)), 1, kExact);
  EXPECT_NEAR(near(s.length.value.x), 2 * 4, 1e-14);  // (0, 2) is at 4
}

TEST(Formulas, ACylinderIsCurvedAcrossItsAxis) {
  // Points of a cylinder of radius 2 around the y axis, at angles ±a and heights ±1 from (0, 0, 2).
  std::vector<Place> places;
  std::vector<Estimate> normals;
  const Real a = 0.001L;
  for (const Real side : {Real{-1}, Real{1}})
    for (const Real y : {Real{-1}, Real{1}}) {
      places.push_back({{2 * std::sin(side * a), y * a, 2 * std::cos(a)}});
      normals.push_back({.value = {std::sin(side * a), 0, std::cos(a)}});
    }
  const Curvatures c = curvature({{0, 0, 2}}, kUp, places, normals);
  EXPECT_NEAR(near(c.k1.value.x), 0.5, 1e-12);
  EXPECT_NEAR(near(c.k2.value.x), 0, 1e-12);
  EXPECT_NEAR(near(std::fabs(c.k1_direction.value.x)), 1, 1e-12);
  EXPECT_NEAR(near(c.mean.value.x), 0.25, 1e-12);
  EXPECT_NEAR(near(c.rms.value.x), std::sqrt(0.125), 1e-12);
}

TEST(Formulas, FairingIsTheWeightedMeanOfProjections) {
  // A neighbour at (1, 0, 0) whose plane is z = x - 1 turned upright: its normal is (-1, 0, 1) / √2.
  const auto number = [](Real v) { return Estimate{.value = {v, 0, 0}}; };
  const Surfel own{kOrigin, kUp, number(1), number(1)};
  const Surfel other{
      {{1, 0, 0}}, {.value = {-1 / std::sqrt(Real{2}), 0, 1 / std::sqrt(Real{2})}}, number(2), number(0.5)};
  const Real f = 0.7L, g = 0.9L;
  const Real weight = 2 * std::exp(-1 / (2 * f * f)) * std::exp(-0.5L / (2 * g * g));  // areas are 2 and 1 times π
  const Estimate p = faired(own, std::vector<Surfel>{other}, f, g);
  EXPECT_NEAR(near(p.value.x), near(weight * 0.5L / (1 + weight)), kExact);
  EXPECT_NEAR(near(p.value.z), near(weight * -0.5L / (1 + weight)), kExact);
}

TEST(Formulas, WhatTheDataDoNotTellIsOpen) {
  const std::vector<Place> square{{{1, 0, 0}}, {{-1, 0, 0}}, {{0, 1, 0}}, {{0, -1, 0}}};
  const Splat s = splat(kOrigin, kUp, square, nullptr);
  EXPECT_TRUE(s.axis.is_open()) << "a circle has no major axis";
  EXPECT_FALSE(s.length.is_open());
  EXPECT_LT(near(s.length.error), 1e-5);
  std::vector<Place> cube = square;
  cube.insert(cube.end(), {{{0, 0, 1}}, {{0, 0, -1}}});
  EXPECT_TRUE(normal(kOrigin, cube, {}).is_open());
}

TEST(Formulas, AMovedPlaceCarriesItsErrorOn) {
  std::vector<Place> moved = kCross;
  moved[1].error = 1e-6L;
  EXPECT_EQ(near(distance(kOrigin, kCross[1]).error), 0);
  EXPECT_GE(near(distance(kOrigin, moved[1]).error), 1e-6);
  EXPECT_GT(near(splat(kOrigin, kUp, moved, nullptr).length.error),
            near(splat(kOrigin, kUp, kCross, nullptr).length.error) + 1e-6);
}

}  // namespace
}  // namespace pointsweep::formulas
