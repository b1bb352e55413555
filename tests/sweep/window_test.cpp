// SPDX-License-Identifier: MIT
/// Cells that are ready, and cells that may be dropped, against the plain statement of both rules.
#include "pointsweep/sweep/window.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <utility>

#include "pointsweep/operators/surface/curvature.h"
#include "pointsweep/operators/surface/normals.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/sweep/slab_loader.h"
#include "tests/support/memory_source.h"

namespace pointsweep {
namespace {

constexpr double kRadius = 0.05;

/// Slabs of a thin block along x. Neighbourhoods are all points within kRadius, so that the reach of every cell is
/// known.
class WindowTest : public testing::Test {
 protected:
  WindowTest()
      : source_(source_of(points_)),
        pass_(plan_chain({.neighborhood = {.k = Neighborhood::kUnlimited, .radius = kRadius},
                          .stages = {std::make_shared<Normals>(), std::make_shared<Curvature>()}},
                         source_.schema)
                  .passes.front()),
        stream_(source_, survey(source_, std::nullopt, true), thin_slabs()),
        frontier_(stream_.slabs(), stream_.axis()),
        window_((pass_.bind(stream_.record_schema()), pass_.plan), frontier_) {}

  static std::vector<Vec3> block() {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> u(0, 1);
    std::vector<Vec3> points(20'000);
    for (Vec3& p : points) p = {u(random), 0.1 * u(random), 0.1 * u(random)};
    return points;
  }
  static StreamOptions thin_slabs() {
    StreamOptions options;
    options.slab_points = 1000;
    return options;
  }

  /// Reads the next slab into the window.
  void read_slab() {
    const auto slab = static_cast<std::uint32_t>(frontier_.slabs_read());
    for (auto& cell : SlabLoader(stream_, pass_.plan, 128).load(slab, false).cells) window_.admit(std::move(cell));
    frontier_.slab_was_read();
  }
  bool all_read() const { return frontier_.slabs_read() == stream_.slabs().size(); }

  double distance_to_unread(const WindowCell& cell) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t s = frontier_.slabs_read(); s < stream_.slabs().size(); ++s)
      least = std::min(least, std::sqrt(distance2(stream_.slabs()[s].box, cell.cell.box)));
    return least;
  }
  std::set<std::uint32_t> occupied() const { return {window_.occupied().begin(), window_.occupied().end()}; }

  std::vector<Vec3> points_ = block();
  PointSource source_;
  PlannedPass pass_;
  Stream stream_;
  Frontier frontier_;
  Window window_;
};

TEST_F(WindowTest, ACellIsReadyForTheSearchOnceNoUnreadSlabIsWithinItsReach) {
  std::size_t waited = 0;
  while (!all_read()) {
    read_slab();
    const std::vector<std::uint32_t> ready = window_.ready_for(0);
    ASSERT_TRUE(std::is_sorted(ready.begin(), ready.end()));
    for (const std::uint32_t slot : window_.occupied()) {
      const bool far = distance_to_unread(window_.at(slot)) > kRadius;
      waited += far ? 0 : 1;
      ASSERT_EQ(std::binary_search(ready.begin(), ready.end(), slot), far);
    }
  }
  EXPECT_GT(waited, 0u);
}

TEST_F(WindowTest, ACellThatWasToldToWaitForASlabDoes) {
  while (window_.ready_for(0).empty()) read_slab();
  ASSERT_FALSE(all_read());
  const std::uint32_t slot = window_.ready_for(0).front();
  window_.at(slot).wait_for_slabs = frontier_.slabs_read() + 1;
  const std::vector<std::uint32_t> ready = window_.ready_for(0);
  EXPECT_EQ(std::ranges::find(ready, slot), ready.end());
}

TEST_F(WindowTest, LaterCellsWaitForMoreWhileManyCellsAreSearchedInVain) {
  while (window_.ready_for(0).size() < 20) read_slab();
  ASSERT_FALSE(all_read());
  const auto expect_reach = [&](double reach) {
    const std::vector<std::uint32_t> ready = window_.ready_for(0);
    for (const std::uint32_t slot : window_.occupied())
      EXPECT_EQ(std::ranges::binary_search(ready, slot), distance_to_unread(window_.at(slot)) > reach);
  };
  const std::vector<std::uint32_t> searched = window_.ready_for(0);
  for (int turn = 0; turn < 5; ++turn) window_.note_searched(searched);
  expect_reach(std::pow(1.05, 5) * kRadius);
  for (int turn = 0; turn < 100; ++turn) window_.note_searched(searched);
  expect_reach(3 * kRadius);

  window_.at(searched.front()).wait_for_slabs = 1;  // a search has found its reach
  EXPECT_TRUE(std::ranges::binary_search(window_.ready_for(0), searched.front()));
  window_.at(searched.front()).wait_for_slabs = 0;

  for (const std::uint32_t slot : searched) window_.at(slot).steps_done = 1;
  for (int turn = 0; turn < 200; ++turn) window_.note_searched(searched);
  for (const std::uint32_t slot : searched) window_.at(slot).steps_done = 0;
  expect_reach(kRadius);
}

TEST_F(WindowTest, NoCellWaitsForSlabsThatTheSweepWillNotRead) {
  Frontier of_part(stream_.slabs(), stream_.axis(), 1);
  Window window(pass_.plan, of_part);
  of_part.slab_was_read();
  for (auto& cell : SlabLoader(stream_, pass_.plan, 64).load(0, false).cells) window.admit(std::move(cell));
  EXPECT_EQ(window.ready_for(0).size(), window.occupied().size());
}

TEST_F(WindowTest, ALaterStepWaitsForEveryCellThatTheListsName) {
  while (!all_read()) read_slab();
  const std::vector<std::uint32_t> slots = window_.ready_for(0);
  const std::uint32_t asking = slots[0], named = slots[1];
  for (const std::uint32_t slot : {asking, named}) window_.at(slot).steps_done = 1;
  window_.at(asking).refers_to = {asking, named};
  EXPECT_EQ(window_.ready_for(1), (std::vector{asking, named}));
  window_.at(named).steps_done = 0;
  EXPECT_EQ(window_.ready_for(1), std::vector<std::uint32_t>{});
  window_.at(named).steps_done = 2;
  EXPECT_EQ(window_.ready_for(1), std::vector{asking});
}

TEST_F(WindowTest, DropsNoCellThatIsUnfinishedOrNamedOrNearToWhatIsUnread) {
  const auto steps = static_cast<std::uint32_t>(pass_.plan.step_count());
  ASSERT_GT(steps, 1u);
  for (int i = 0; i < 6; ++i) read_slab();
  std::mt19937 random(7);
  std::set<std::uint32_t> must_stay, may_go;
  const std::vector<std::uint32_t> slots = window_.occupied();
  for (const std::uint32_t slot : slots) {
    WindowCell& cell = window_.at(slot);
    cell.reach = kRadius;
    cell.steps_done = random() % 4 != 0 ? steps : 1;
    if (cell.steps_done < steps) {
      must_stay.insert(slot);
      cell.refers_to = {slots[random() % slots.size()]};
      must_stay.insert(cell.refers_to.front());
    }
    if (distance_to_unread(cell) <= kRadius) must_stay.insert(slot);
    if (distance_to_unread(cell) > 1.001 * kRadius) may_go.insert(slot);
  }
  for (const std::uint32_t slot : must_stay) may_go.erase(slot);
  ASSERT_FALSE(may_go.empty());
  std::uint64_t points = window_.points();
  for (const std::uint32_t slot : may_go) points -= window_.at(slot).cell.size();
  window_.drop();
  for (const std::uint32_t slot : must_stay) EXPECT_TRUE(occupied().contains(slot));
  for (const std::uint32_t slot : may_go) EXPECT_FALSE(occupied().contains(slot));
  EXPECT_EQ(window_.points(), points);
}

TEST_F(WindowTest, KeepsWhatACellThatIsNotYetSearchedWillLookAt) {
  while (!all_read()) read_slab();
  const auto steps = static_cast<std::uint32_t>(pass_.plan.step_count());
  const std::vector<std::uint32_t> slots = window_.occupied();
  const std::uint32_t waiting = slots[slots.size() / 2];
  for (const std::uint32_t slot : slots) {
    window_.at(slot).reach = kRadius;
    if (slot != waiting) window_.at(slot).steps_done = steps;
  }
  std::vector<std::uint32_t> near,
      far;  // by distances of points, since boxes of leaves lie inside that of their cell
  for (const std::uint32_t slot : slots) {
    const Cell &a = window_.at(waiting).cell, &b = window_.at(slot).cell;
    if (distance2(a.box, b.box) > 1.01 * kRadius * kRadius) far.push_back(slot);
    for (std::uint32_t i = 0; i < a.size(); ++i)
      if (distance2(Box{{a.x[i], a.y[i], a.z[i]}, {a.x[i], a.y[i], a.z[i]}}, b.box) <= kRadius * kRadius) {
        near.push_back(slot);
        break;
      }
  }
  ASSERT_GT(near.size(), 1u);
  ASSERT_FALSE(far.empty());
  window_.drop();
  for (const std::uint32_t slot : near) EXPECT_TRUE(occupied().contains(slot));
  for (const std::uint32_t slot : far) EXPECT_FALSE(occupied().contains(slot));
  window_.at(waiting).steps_done = steps;
  window_.drop();
  EXPECT_TRUE(window_.occupied().empty());
  EXPECT_EQ(window_.points(), 0u);
  std::size_t dropped = 0;
  for (std::uint32_t s = 0; s < stream_.slabs().size(); ++s)
    for (const DroppedCell& cell : frontier_.dropped_of(s)) dropped += cell.points;
  EXPECT_EQ(dropped, points_.size()) << "the frontier knows all that has left";
}

}  // namespace
}  // namespace pointsweep
