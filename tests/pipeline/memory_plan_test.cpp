// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/memory_plan.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "pointsweep/error.h"
#include "pointsweep/pipeline/memory/sample_estimates.h"
#include "pointsweep/sweep/window.h"
#include "tests/pipeline/dense_ball.h"
#include "tests/pipeline/in_memory.h"

namespace pointsweep {
namespace {

SweepPlan normals_plan(std::size_t k = 8) {
  SweepPlan plan;
  plan.neighborhood.k = k;
  plan.steps = {0, 0};
  plan.column_bytes = {12};
  plan.lifetimes = {Lifetime::step};
  plan.result_bytes = 12;
  return plan;
}

/// Returns the plan for a budget that must suffice; throws the Error of fail_budget() if it does not.
MemoryPlan sufficient_plan(std::uint64_t budget, const SweepPlan& plan, const MemoryDemand& demand) {
  const MemoryPlan out = plan_memory(budget, plan, demand);
  if (out.needed_bytes != 0) fail_budget(budget, out.needed_bytes);
  return out;
}

MemoryDemand twenty_million() {
  return {
      .points = 20'000'000, .working_record_bytes = 16, .result_record_bytes = 12, .slab_points = 71'554, .threads = 2};
}

TEST(MemoryPlan, KeepsEverythingInMemoryWhereItFits) {
  const MemoryPlan plan = sufficient_plan(2000 * kMega, normals_plan(), twenty_million());
  EXPECT_FALSE(plan.spill_stream);
  EXPECT_FALSE(plan.spill_results);
  EXPECT_EQ(plan.slab_points, 71'554u);
}

TEST(MemoryPlan, SpillsAsMuchAsTheBudgetAsksFor) {
  const MemoryPlan some = sufficient_plan(480 * kMega, normals_plan(), twenty_million());
  EXPECT_TRUE(some.spill_stream || some.spill_results);
  const MemoryPlan all = sufficient_plan(256 * kMega, normals_plan(), twenty_million());
  EXPECT_TRUE(all.spill_stream);
  for (const MemoryPlan& plan : {some, all}) EXPECT_LE(plan.expected_bytes, 480 * kMega);
}

TEST(MemoryPlan, ExpectsNoMoreThanTheBudgetForAnyCloud) {
  for (const std::uint64_t points : {1'000ull, 1'000'000ull, 100'000'000ull, 10'000'000'000ull}) {
    for (const std::uint64_t budget : {48 * kMega, 256 * kMega, 4096 * kMega}) {
      MemoryDemand demand = twenty_million();
      demand.points = points;
      try {
        EXPECT_LE(sufficient_plan(budget, normals_plan(), demand).expected_bytes, budget) << points;
      } catch (const Error& e) {
        EXPECT_NE(std::string(e.what()).find("--memory"), std::string::npos);
      }
    }
  }
}

/// Lists from which edges are made are shorter, so that lists and edges fit into the memory that lists alone may take.
TEST(MemoryPlan, ListsLeaveRoomForTheEdgesThatAreMadeOfThem) {
  const MemoryPlan lists = sufficient_plan(256 * kMega, normals_plan(), twenty_million());
  MemoryDemand demand = twenty_million();
  demand.listed_edge_bytes = 156;
  const MemoryPlan edges = sufficient_plan(256 * kMega, normals_plan(), demand);
  EXPECT_LE(edges.lists_bytes / sizeof(NeighborRef) * (sizeof(NeighborRef) + 156), lists.lists_bytes);
  EXPECT_GE(edges.lists_bytes / sizeof(NeighborRef) * (sizeof(NeighborRef) + 156), lists.lists_bytes / 2);
  demand.most_neighbors = 100'000;  // the lists of a single point must always fit
  SweepPlan radius = normals_plan(Neighborhood::kUnlimited);
  const std::uint64_t with = sufficient_plan(1024 * kMega, radius, demand).expected_bytes;
  demand.listed_edge_bytes = 0;
  EXPECT_GE(with, sufficient_plan(1024 * kMega, radius, demand).expected_bytes + 2 * 100'000 * 156);
}

SweepPlan three_steps(std::size_t k) {
  SweepPlan plan = normals_plan(k);
  plan.steps = {0, 0, 0, 0};
  plan.column_bytes = {12, 36, 24};
  plan.lifetimes = {Lifetime::cell, Lifetime::cell, Lifetime::step};
  plan.result_bytes = 72;
  return plan;
}

std::uint64_t named_megabytes(const SweepPlan& plan, const MemoryDemand& demand) {
  try {
    sufficient_plan(kMega, plan, demand);
    ADD_FAILURE() << "one megabyte is not enough for anything";
  } catch (const Error& e) {
    const std::string text = e.what();
    return std::stoull(text.substr(text.find("--memory ") + 9));
  }
  return 0;
}

TEST(MemoryPlan, NamesTheLeastBudgetThatDoes) {
  for (const std::size_t k : {std::size_t{8}, std::size_t{1000}, std::size_t{100'000}, Neighborhood::kUnlimited}) {
    for (const std::uint64_t points : {1000ull, 1'000'000ull, 60'000'000ull, 500'000'000ull, 5'000'000'000ull}) {
      for (const std::uint64_t slab : {16'384, 71'554, 2'000'000}) {
        for (const SweepPlan& plan : {normals_plan(k), three_steps(k)}) {
          MemoryDemand demand = twenty_million();
          demand.points = points;
          demand.slab_points = slab;
          demand.most_neighbors = points / 10;
          demand.slice_points = points / 20;
          const std::uint64_t named = named_megabytes(plan, demand);
          SCOPED_TRACE(fmt::format("k {} of {}, slabs of {}: {}M", k, points, slab, named));
          EXPECT_NO_THROW(sufficient_plan(named * kMega, plan, demand));
          EXPECT_THROW(sufficient_plan((named - 1) * kMega, plan, demand), Error);
        }
      }
    }
  }
}

TEST(MemoryPlan, NeverFailsWithMoreWhereLessDoes) {
  for (const std::size_t k : {std::size_t{8}, std::size_t{1000}, Neighborhood::kUnlimited}) {
    MemoryDemand demand = twenty_million();
    demand.points = 300'000'000;
    demand.slab_points = 300'000;
    bool did = false;
    for (std::uint64_t mega = 16; mega < 20'000; mega += 1 + mega / 64) {
      const bool does = plan_memory(mega * kMega, three_steps(k), demand).needed_bytes == 0;
      EXPECT_TRUE(does || !did) << mega << "M";
      did = did || does;
    }
    EXPECT_TRUE(did);
  }
}

TEST(MemoryPlan, CountsTheWindowThatARadiusKeeps) {
  MemoryDemand demand = twenty_million();
  const MemoryPlan thin = plan_memory(8192 * kMega, normals_plan(Neighborhood::kUnlimited), demand);
  demand.slice_points = 5'000'000;
  const MemoryPlan thick = plan_memory(8192 * kMega, normals_plan(Neighborhood::kUnlimited), demand);
  EXPECT_GE(thick.window_bytes, thin.window_bytes + 5'000'000 * 40);
}

/// A cell of a later step waits for its neighbours, which wait for their own neighbours, however thin the slabs are.
TEST(MemoryPlan, CountsThePointsThatWaitForSeveralSteps) {
  MemoryDemand demand = twenty_million();
  demand.slab_points = 1024;
  SweepPlan chain = normals_plan();
  const std::uint64_t one = sufficient_plan(4096 * kMega, chain, demand).window_bytes;
  chain.steps = {0, 0, 0, 0};
  const std::uint64_t three = sufficient_plan(4096 * kMega, chain, demand).window_bytes;
  EXPECT_GE(three, 200'000 * window_point_bytes(chain));
  EXPECT_LT(one, three / 4);
  demand.points = 10'000;
  EXPECT_LT(sufficient_plan(4096 * kMega, chain, demand).window_bytes, three / 4);
}

/// Measured for a million points: the window held up to 478,449 points with slabs of 16,384 (three steps, k = 64), and
/// 212,000 for two steps and k = 8 with slabs of 8,192.
TEST(MemoryPlan, CountsThePointsThatUnevenDensityMakesWait) {
  const Survey survey = survey_of_dense_ball();
  MemoryDemand demand = {
      .points = 1'000'000, .working_record_bytes = 28, .result_record_bytes = 56, .slab_points = 16'384};
  SweepPlan chain = normals_plan(64);
  const auto window = [&](std::vector<std::size_t> steps) {
    chain.steps = std::move(steps);
    const std::uint64_t neighbors = window_neighbors(chain, 1024, survey.dimension);
    demand.waiting_for_steps = estimate_open_points(survey, demand.points, neighbors);
    return plan_memory(64 * kMega, chain, demand).window_bytes / window_point_bytes(chain);  // in points
  };
  EXPECT_GE(window({0, 0, 0, 0}), 478'449u);
  EXPECT_LE(window({0, 0, 0, 0}), 2 * 478'449u);
  chain.neighborhood.k = 8;
  demand.slab_points = 8'192;
  EXPECT_GE(window({0, 0, 0}), 212'000u);
}

TEST(MemoryPlan, CountsWhatEachThreadHasInHand) {
  MemoryDemand demand = twenty_million();
  const auto window = [&](unsigned threads) {
    demand.threads = threads;
    return plan_memory(8192 * kMega, normals_plan(1000), demand).window_bytes;
  };
  const std::uint64_t slab = demand.slab_points * demand.working_record_bytes,
                      lists = 1024 * 1000 * sizeof(NeighborRef);
  EXPECT_GE(window(9), window(1) + 8 * (slab + lists));
}

TEST(MemoryPlan, ATurnHasEightCellsForEachThreadWhereMemoryIsLeft) {
  MemoryDemand demand = twenty_million();
  const auto at = [&](unsigned threads, std::uint64_t mega) {
    demand.threads = threads;
    return plan_memory(mega * kMega, normals_plan(), demand);
  };
  EXPECT_EQ(at(2, 8192).slabs_per_turn, 1u) << "one slab has many times as many cells";
  for (const unsigned threads : {16u, 64u, 256u}) {
    const MemoryPlan plan = at(threads, 8192);
    const double cells = 1024 * 5.0 / 8, slabs = 8 * threads * cells / 71'554;
    EXPECT_GE(plan.slabs_per_turn, slabs) << threads;
    EXPECT_LT(plan.slabs_per_turn, slabs + 1) << threads;
  }
  for (const std::uint64_t mega : {256, 512, 1024}) {
    const MemoryPlan plan = at(64, mega);
    EXPECT_TRUE(plan.needed_bytes != 0 || plan.expected_bytes <= mega * kMega) << mega;
  }
  const std::uint64_t least = at(64, 1).needed_bytes / kMega;
  EXPECT_EQ(at(64, least).slabs_per_turn, 1u) << "the least budget is that of a run whose turns have one slab";
}

TEST(MemoryPlan, CountsWhatGrowsWithTheCloudThoughItIsSpilled) {
  const auto at = [](std::uint64_t points) {
    MemoryDemand demand = twenty_million();
    demand.points = points;
    return named_megabytes(normals_plan(), demand);
  };
  // At least the boxes of dropped cells, 48 bytes for each thousand points.
  EXPECT_GE(at(2'000'000'000), at(1'000'000'000) + 48 * 1'000'000 / kMega);
}

}  // namespace
}  // namespace pointsweep
