// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/slab_loader.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <vector>

#include "pointsweep/operators/surface/normals.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "tests/support/memory_source.h"

namespace pointsweep {
namespace {

constexpr std::uint32_t kCellPoints = 64;

/// Returns a dense sheet, outliers around it, and 300 copies of a point, which are more than a cell holds.
std::vector<Vec3> sheet_with_outliers_and_copies() {
  std::mt19937_64 rng(11);
  std::uniform_real_distribution<double> u(0, 1);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < 5000; ++i)
    points.push_back(i % 100 == 7 ? Vec3{30 * u(rng) - 15, 30 * u(rng) - 15, 30 * u(rng) - 15}
                                  : Vec3{u(rng), u(rng), 0.01 * u(rng)});
  for (std::size_t i = 0; i < 300; ++i) points.insert(points.begin() + static_cast<int>(17 * i), {0.5, 0.5, 0.005});
  return points;
}

struct StreamInSlabs {
  std::vector<Vec3> points = sheet_with_outliers_and_copies();
  PointSource source = source_of(points);
  PlannedPass planned =
      plan_chain({.neighborhood = {}, .stages = {std::make_shared<Normals>()}}, source.schema).passes.front();
  Stream stream{source, survey(source, std::nullopt, true), options()};
  SlabLoader loader{stream, planned.plan, kCellPoints};

  static StreamOptions options() {
    StreamOptions slabs;
    slabs.slab_points = 700;
    slabs.canonical = false;
    return slabs;
  }
};

void expect_same_cell(const WindowCell& a, const WindowCell& b) {
  EXPECT_EQ(a.slab, b.slab);
  EXPECT_EQ(a.number, b.number);
  ASSERT_EQ(a.cell.size(), b.cell.size());
  EXPECT_EQ(a.index_in_slab, b.index_in_slab);
  for (std::uint32_t i = 0; i < a.cell.size(); ++i) {
    EXPECT_EQ(a.cell.row[i], b.cell.row[i]);
    const Vec3 p = a.cell.position(i), q = b.cell.position(i);
    EXPECT_TRUE(p.x == q.x && p.y == q.y && p.z == q.z);
  }
}

TEST(SlabLoader, PutsEveryPointOfTheCloudIntoOneSmallCellAtItsPosition) {
  const StreamInSlabs in;
  std::vector<int> seen(in.points.size());
  for (std::uint32_t slab = 0; slab < in.stream.slabs().size(); ++slab) {
    const LoadedSlab loaded = in.loader.load(slab, false);
    std::vector<int> places(in.stream.slabs()[slab].count);
    for (std::size_t c = 0; c < loaded.cells.size(); ++c) {
      const WindowCell& cell = *loaded.cells[c];
      ASSERT_EQ(cell.number, c);
      ASSERT_EQ(cell.slab, slab);
      ASSERT_GT(cell.cell.size(), 0u);
      ASSERT_LE(cell.cell.size(), kCellPoints);
      for (std::uint32_t i = 0; i < cell.cell.size(); ++i) {
        ++places[cell.index_in_slab[i]];
        const Vec3 at = cell.cell.position(i), is = in.points[cell.cell.row[i]];
        ASSERT_TRUE(at.x == is.x && at.y == is.y && at.z == is.z);
        ASSERT_EQ(distance2(cell.cell.box, at), 0);
        ++seen[cell.cell.row[i]];
      }
    }
    ASSERT_TRUE(std::ranges::all_of(places, [](int n) { return n == 1; }));
  }
  EXPECT_TRUE(std::ranges::all_of(seen, [](int n) { return n == 1; }));
}

TEST(SlabLoader, MakesTheSameCellsAgain) {
  const StreamInSlabs in;
  ASSERT_GT(in.stream.slabs().size(), 3u);
  for (std::uint32_t slab = 0; slab < in.stream.slabs().size(); ++slab) {
    const LoadedSlab all = in.loader.load(slab, false), again = in.loader.load(slab, false);
    ASSERT_EQ(all.cells.size(), again.cells.size());
    for (std::size_t c = 0; c < all.cells.size(); ++c) expect_same_cell(*all.cells[c], *again.cells[c]);
  }
}

TEST(SlabLoader, MakesCellsOfSomePointsThatKnowTheirPlaces) {
  const StreamInSlabs in;
  const LoadedSlab loaded = in.loader.load(2, true);
  const std::size_t stride = in.stream.record_schema().stride;
  std::vector<std::uint32_t> places;
  std::vector<std::byte> records;
  for (std::uint32_t place = 1; place < in.stream.slabs()[2].count; place += 3) {
    places.push_back(place);
    records.insert(records.end(), loaded.records.begin() + std::ptrdiff_t(place * stride),
                   loaded.records.begin() + std::ptrdiff_t((place + 1) * stride));
  }
  std::map<std::uint32_t, std::uint64_t> row_at_place, row_of_some;
  for (const auto& cell : loaded.cells)
    for (std::uint32_t i = 0; i < cell->cell.size(); ++i) row_at_place[cell->index_in_slab[i]] = cell->cell.row[i];
  for (const auto& cell : in.loader.cells_of(2, places, records)) {
    EXPECT_EQ(cell->slab, 2u);
    for (std::uint32_t i = 0; i < cell->cell.size(); ++i) row_of_some[cell->index_in_slab[i]] = cell->cell.row[i];
  }
  ASSERT_EQ(row_of_some.size(), places.size());
  for (const std::uint32_t place : places) EXPECT_EQ(row_of_some.at(place), row_at_place.at(place));
}

TEST(SlabLoader, KeepsTheRecordsInTheOrderOfTheStreamIfAskedFor) {
  const StreamInSlabs in;
  const LoadedSlab loaded = in.loader.load(1, true);
  const std::size_t stride = in.stream.record_schema().stride;
  std::vector<std::byte> records(in.stream.slabs()[1].count * stride);
  in.stream.read(1, records);
  EXPECT_EQ(loaded.records, records);
  EXPECT_TRUE(in.loader.load(1, false).records.empty());
}

/// A long cell that covers a sheet and its outliers would be searched for every point near it.
TEST(SlabLoader, KeepsOutliersOutOfTheCellsOfASheet) {
  const StreamInSlabs in;
  std::size_t narrow = 0, cells = 0;
  for (std::uint32_t slab = 0; slab < in.stream.slabs().size(); ++slab) {
    for (const auto& cell : in.loader.load(slab, false).cells) {
      ++cells;
      narrow += cell->cell.box.diagonal() < 2 ? 1 : 0;
    }
  }
  EXPECT_GT(narrow, cells * 8 / 10);
}

}  // namespace
}  // namespace pointsweep
