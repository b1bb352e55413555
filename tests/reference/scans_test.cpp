// SPDX-License-Identifier: MIT
// The reference engine on real scans.
#include <gtest/gtest.h>

#include "tests/reference/reference_runs.h"
#include "tests/support/brute_force.h"
#include "tests/support/data_folder.h"

namespace pointsweep {
namespace {

struct Scan {
  const char* file;
  const char* meaning;
  double radius;  ///< radius of the smaller neighbourhoods

  friend void PrintTo(const Scan& scan, std::ostream* out) { *out << scan.file; }
};

constexpr Scan kScans[] = {
    {"lidar/jakteristics_mobile/test_0.02_seconde.las", "lines of a vehicle's scanner", 0.5},
    {"models/stanford_bunny/data/bun000.ply", "one range image", 0.002},
    {"lidar/lasR/Megaplot.las", "airborne scan of a forest", 2},
};

std::vector<Vec3> positions(InputCloud& cloud) {
  const Schema& schema = cloud.schema();
  const std::size_t n = cloud.count();
  std::vector<std::byte> records(n * schema.stride);
  for (std::size_t row = 0; row < n;) row += cloud.read(row, std::span(records).subspan(row * schema.stride));
  std::vector<double> x(n), y(n), z(n);
  decode_positions(position_fields(schema, "the scan"), records.data(), schema.stride, n, x.data(), y.data(), z.data());
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < n; ++i) points.push_back({x[i], y[i], z[i]});
  return points;
}

class ReferenceScans : public testing::TestWithParam<Scan> {
 protected:
  void SetUp() override {
    if (data_folder().empty()) GTEST_SKIP() << "the folder of real clouds is absent; set POINTSWEEP_DATA to it";
    cloud_.emplace(std::vector{data_folder() / GetParam().file});
    points_ = positions(*cloud_);
  }
  NeighborRun run(const Neighborhood& neighborhood, const EngineOptions& options) {
    return neighbor_run(*cloud_, points_, neighborhood, 16, options);
  }

  std::optional<InputCloud> cloud_;
  std::vector<Vec3> points_;
};

TEST_P(ReferenceScans, DifferInAsManyListsAsTheAuditCountsInEitherOrder) {
  const Lists exact = run({.k = 8}, by(Engine::exact)).lists;
  const NeighborRun input = run({.k = 8}, by(Engine::reference, Order::input, 0));
  const NeighborRun sweep = run({.k = 8}, by(Engine::reference, Order::sweep));
  EXPECT_EQ(input.statistics.reference->incomplete, differing(input.lists, exact));
  EXPECT_GT(input.statistics.reference->incomplete, 0u);
  EXPECT_EQ(input.records, sweep.records);
  EXPECT_EQ(input.entered, canonical_rows(points_));
  EXPECT_EQ(sweep.entered, input.entered);
  EXPECT_EQ(input.statistics.peak_points, sweep.statistics.peak_points);
  for (std::uint32_t i = 0; i < points_.size(); i += 199)
    ASSERT_EQ(exact[i], brute_force_neighbors_of(points_, i, 8, Box::kInf)) << i;
}

TEST_P(ReferenceScans, HaveExactNeighborhoodsWithinARadius) {
  const Neighborhood within{.k = Neighborhood::kUnlimited, .radius = GetParam().radius};
  const NeighborRun exact = run(within, by(Engine::exact));
  for (const Order order : kOrders) {
    const NeighborRun found = run(within, by(Engine::reference, order, 0));
    EXPECT_EQ(found.records, exact.records);
    EXPECT_EQ(found.statistics.reference->incomplete, 0u);
  }
  for (std::uint32_t i = 0; i < points_.size(); i += 199)
    ASSERT_EQ(exact.counts[i], double(brute_force_neighbors_of(points_, i, points_.size(), within.radius).size())) << i;
}

INSTANTIATE_TEST_SUITE_P(OfAllKinds, ReferenceScans, testing::ValuesIn(kScans),
                         [](const auto& scan) { return "Scan" + std::to_string(scan.index); });

}  // namespace
}  // namespace pointsweep
