// SPDX-License-Identifier: MIT
#include "pointsweep/operators/surface/features.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "pointsweep/error.h"
#include "tests/operators/mixed_cloud.h"
#include "tests/support/brute_force.h"
#include "tests/support/in_core.h"
#include "tests/support/instruction_sets.h"

namespace pointsweep {
namespace {

using Lists = std::vector<std::vector<std::uint32_t>>;

/// Returns the values of the first point, whose neighbours are all other points, by name.
std::map<std::string, double> of_first(const std::vector<Vec3>& points, const FeaturesOptions& options = {}) {
  Lists lists(points.size());
  for (std::uint32_t j = 1; j < points.size(); ++j) lists[0].push_back(j);
  std::ranges::sort(lists[0], {}, [&](std::uint32_t j) { return distance2(points[j], points[0]); });
  const Features op(options);
  const InCoreResult result = InCoreCloud(points, lists).apply(op);
  std::map<std::string, double> values;
  const Contract contract = op.contract();
  for (std::size_t m = 0; m < contract.makes.size(); ++m)
    values[contract.makes[m].name] =
        contract.makes[m].type == Type::u32 ? result.column<std::uint32_t>(m)[0] : double(result.column<float>(m)[0]);
  values["degenerate"] = !result.degenerate_rows.empty() && result.degenerate_rows.front() == 0;
  return values;
}

/// Expects equality up to the rounding of float32.
void expect_close(double got, double want) { EXPECT_NEAR(got, want, 2e-7 * std::abs(want)); }

/// Variances 4, 1 and 1/4 along x, y and z about the first point: l = 8/7, 2/7 and 1/14 of seven points.
const std::vector<Vec3> kCross = {{0, 0, 0}, {2, 0, 0}, {-2, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 0.5}, {0, 0, -0.5}};

TEST(Features, OfACrossAreWhatOneCalculatesByHand) {
  const double l1 = 8 / 7.0, l2 = 2 / 7.0, l3 = 0.5 / 7;
  auto f = of_first(kCross);
  expect_close(f["linearity"], 0.75);
  expect_close(f["planarity"], 3 / 16.0);
  expect_close(f["sphericity"], 1 / 16.0);
  expect_close(f["anisotropy"], 15 / 16.0);
  expect_close(f["omnivariance"], std::cbrt(l1 * l2 * l3));
  expect_close(f["eigenvalue_sum"], l1 + l2 + l3);
  expect_close(f["eigenentropy"], -(l1 * std::log(l1) + l2 * std::log(l2) + l3 * std::log(l3)));
  expect_close(f["surface_variation"], 1 / 21.0);
  EXPECT_EQ(f["verticality"], 0);
  EXPECT_EQ(f["moment1_axis1"], 0);
  expect_close(f["moment2_axis1"], 8);
  expect_close(f["moment2_axis2"], 2);
  EXPECT_EQ(f["height_range"], 1);
  EXPECT_EQ(f["number_of_neighbors"], 7);
  EXPECT_EQ(f["degenerate"], 0);
}

TEST(Features, OfRootsAndOfNormalizedValuesAreTheSameFormulas) {
  auto roots = of_first(kCross, {.eigenvalues = EigenvalueScale::root});
  expect_close(roots["linearity"], 0.5);
  expect_close(roots["planarity"], 0.25);
  expect_close(roots["eigenvalue_sum"], 3.5 / std::sqrt(3.5));
  expect_close(roots["omnivariance"], 1 / std::sqrt(3.5));
  auto shares = of_first(kCross, {.eigenvalues = EigenvalueScale::normalized});
  expect_close(shares["linearity"], 0.75);
  expect_close(shares["eigenvalue_sum"], 1);
  expect_close(shares["omnivariance"], 4 / 21.0);
}

TEST(Features, WithoutThePointAreThoseOfItsNeighbours) {
  std::vector<Vec3> points = kCross;
  points[0] = {100, 30, 7};  // far away: sums about p_i would lose the neighbours' own extent
  auto f = of_first(points, {.with_point = false});
  expect_close(f["linearity"], 0.75);
  expect_close(f["eigenvalue_sum"], 10.5 / 6);
  expect_close(f["moment1_axis1"], 600);
  expect_close(f["moment1_axis2"], 180);
  expect_close(f["moment2_axis1"], 6 * 1e4 + 8);
  expect_close(f["moment2_axis2"], 6 * 900 + 2);
  EXPECT_EQ(f["height_range"], 1);
  EXPECT_EQ(f["number_of_neighbors"], 6);
}

TEST(Features, OfAWallAreVerticalAndScaleWithItsSize) {
  std::vector<Vec3> wall = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {1, 0, 1.25}, {2, 0, 0.5}};
  auto small = of_first(wall);
  EXPECT_EQ(small["verticality"], 1);
  EXPECT_EQ(small["sphericity"], 0);
  EXPECT_EQ(small["omnivariance"], 0);
  const double size = 0x1p30;
  for (Vec3& p : wall) p = size * p;
  auto large = of_first(wall);
  for (const char* same : {"linearity", "planarity", "surface_variation", "verticality"})
    EXPECT_EQ(large[same], small[same]) << same;
  for (const char* squared : {"eigenvalue_sum", "moment2_axis1", "moment2_axis2"})
    EXPECT_EQ(large[squared], size * size * small[squared]) << squared;
  EXPECT_EQ(large["moment1_axis1"], size * small["moment1_axis1"]);
  const double sum = small["eigenvalue_sum"];
  EXPECT_NEAR(large["eigenentropy"] / (size * size), small["eigenentropy"] - 60 * std::numbers::ln2 * sum, 1e-4);
}

TEST(Features, OfDegenerateNeighborhoodsAreTheDocumentedValues) {
  auto line = of_first({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {-1, -1, -1}});
  expect_close(line["linearity"], 1);
  EXPECT_EQ(line["verticality"], 0);
  EXPECT_EQ(line["degenerate"], 1);
  EXPECT_EQ(of_first({{0, 0, 0}, {1, 1, 1}}, {.names = {"linearity"}})["degenerate"], 0);
  for (const bool with_point : {true, false}) {
    for (const std::vector<Vec3>& points : {std::vector<Vec3>{{1, 2, 3}}, std::vector<Vec3>(9, Vec3{1, 2, 3})}) {
      auto place = of_first(points, {.with_point = with_point});
      EXPECT_EQ(place["degenerate"], 1);
      EXPECT_EQ(place["number_of_neighbors"], points.size() - (with_point ? 0 : 1));
      place.erase("number_of_neighbors"), place.erase("degenerate");
      for (const auto& [name, value] : place) EXPECT_EQ(value, 0) << name;
    }
  }
  auto nowhere = of_first({{0, 0, 0}, {1, 0, 0}, {0, 1, 1e308}, {0, 1, -INFINITY}});
  EXPECT_EQ(nowhere["number_of_neighbors"], 4);
  EXPECT_EQ(nowhere["height_range"], 0);
  EXPECT_EQ(nowhere["linearity"], 0);
}

TEST(Features, HaveTheSameBitsOnEveryInstructionSetAndInEveryBatch) {
  const MixedCloud cloud(1729);
  for (const EigenvalueScale scale : {EigenvalueScale::raw, EigenvalueScale::root, EigenvalueScale::normalized}) {
    for (const bool with_point : {true, false}) {
      const Features op({.eigenvalues = scale, .with_point = with_point});
      const auto whole = InCoreCloud(cloud.points, cloud.lists).apply(op);
      for_each_instruction_set(
          [&] { EXPECT_EQ(InCoreCloud(cloud.points, cloud.lists).apply(op).columns, whole.columns); });
      for (const std::size_t cell_points : {1u, 2u, 3u, 7u, 15u, 17u, 100u}) {
        const auto parts = InCoreCloud(cloud.points, cloud.lists, cell_points).apply(op);
        EXPECT_EQ(parts.columns, whole.columns) << cell_points;
        EXPECT_EQ(parts.degenerate_rows, whole.degenerate_rows) << cell_points;
      }
    }
  }
}

TEST(Features, RefuseNamesThatAreNoneAndMakeTheOthersInOneOrder) {
  EXPECT_THROW(Features({.names = {"linearity", "straightness"}}), UsageError);
  EXPECT_THROW(Features({.names = {"linearity", "linearity"}}), UsageError);
  const Features op({.names = {"verticality", "linearity"}});
  ASSERT_EQ(op.contract().makes.size(), 2u);
  EXPECT_EQ(op.contract().makes[0].name, "linearity");
  EXPECT_EQ(op.declared_options(), Features({.names = {"linearity", "verticality"}}).declared_options());
  EXPECT_EQ(Features().contract().makes.size(), kFeatures);
}

}  // namespace
}  // namespace pointsweep
