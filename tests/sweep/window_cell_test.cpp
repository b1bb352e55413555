// SPDX-License-Identifier: MIT

#include <gtest/gtest.h>

#include <random>

#include "pointsweep/operators/surface/normals.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/sweep/slab_loader.h"
#include "pointsweep/sweep/window.h"
#include "tests/support/memory_source.h"

namespace pointsweep {
namespace {

/// Returns the bytes that the allocator uses for a block: 16 more than asked for, rounded up to a multiple of 16.
std::uint64_t allocated(std::uint64_t bytes) { return bytes == 0 ? 0 : (bytes + 16 + 15) / 16 * 16; }

template <class T>
std::uint64_t allocated(const std::vector<T>& values) {
  return allocated(values.capacity() * sizeof(T));
}

/// Returns the bytes of a cell that the window holds before its search, without the values of its columns.
std::uint64_t bytes_of(const WindowCell& cell) {
  return allocated(sizeof(WindowCell)) + allocated(cell.cell.memory_bytes()) + allocated(cell.index_in_slab) +
         allocated(cell.leaf_reach) + allocated(cell.columns) + allocated(cell.column_pointers);
}

TEST(WindowCell, TakesWhatTheMemoryPlanCountsForItsPoints) {
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> u(0, 1);
  std::vector<Vec3> points(60'000);
  for (Vec3& p : points) p = {u(rng), u(rng), 0.1 * u(rng)};
  const PointSource source = source_of(points);
  PlannedPass pass =
      plan_chain({.neighborhood = {}, .stages = {std::make_shared<Normals>()}}, source.schema).passes.front();
  StreamOptions slabs;
  slabs.slab_points = 20'000;
  const Stream stream(source, survey(source, std::nullopt, true), slabs);
  pass.bind(stream.record_schema());
  std::uint64_t bytes = 0, cells = 0;
  for (std::uint32_t slab = 0; slab < stream.slabs().size(); ++slab) {
    for (const auto& cell : SlabLoader(stream, pass.plan, 1024).load(slab, false).cells) {
      expect_reaches(*cell, pass.plan.neighborhood);
      bytes += bytes_of(*cell);
      ++cells;
    }
  }
  ASSERT_GT(cells, 50u);
  const std::uint64_t counted = (window_point_bytes(pass.plan) - pass.plan.cell_lifetime_bytes()) * points.size();
  EXPECT_LE(bytes, counted);
  EXPECT_GE(bytes, counted * 3 / 4) << "more would waste the budget";
}

TEST(WindowCell, CountsThePartsOfAPointByTheirSizes) {
  SweepPlan plan;
  const Cell cell(16 * kLeafCapacity);  // leaves are allocated 16 at a time
  EXPECT_EQ(cell.memory_bytes() + 16 * kLeafCapacity * sizeof(std::uint32_t) + 16 * sizeof(double),
            16 * (kLeafCapacity * kOwnPointBytes + kWindowLeafBytes));
  const std::uint64_t empty = window_point_bytes(plan);
  plan.column_bytes = {12, 8};
  plan.lifetimes = {Lifetime::cell, Lifetime::step};
  EXPECT_EQ(window_point_bytes(plan), empty + 12) << "a column of a step alone is not in the window";
}

}  // namespace
}  // namespace pointsweep
