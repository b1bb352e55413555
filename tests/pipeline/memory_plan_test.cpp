// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/memory_plan.h"

#include <gtest/gtest.h>

#include "pointsweep/error.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kMega = 1 << 20;

SweepPlan normals_plan(std::size_t k = 8) {
  SweepPlan plan;
  plan.neighborhood.k = k;
  plan.steps = {0, 0};
  plan.column_bytes = {12};
  plan.lasting = {Lasting::its_step};
  plan.result_bytes = 12;
  return plan;
}

MemoryDemand twenty_million() {
  return {
      .points = 20'000'000, .working_record_bytes = 16, .result_record_bytes = 12, .slab_points = 71'554, .threads = 2};
}

TEST(MemoryPlan, KeepsEverythingInMemoryWhereItFits) {
  const MemoryPlan plan = plan_memory(2000 * kMega, normals_plan(), twenty_million());
  EXPECT_FALSE(plan.spill_stream);
  EXPECT_FALSE(plan.spill_results);
  EXPECT_EQ(plan.slab_points, 71'554u);
}

TEST(MemoryPlan, SpillsAsMuchAsTheBudgetAsksFor) {
  const MemoryPlan some = plan_memory(480 * kMega, normals_plan(), twenty_million());
  EXPECT_TRUE(some.spill_stream || some.spill_results);
  const MemoryPlan all = plan_memory(256 * kMega, normals_plan(), twenty_million());
  EXPECT_TRUE(all.spill_stream);
  for (const MemoryPlan& plan : {some, all}) EXPECT_LE(plan.expected_bytes, 480 * kMega);
}

TEST(MemoryPlan, ExpectsNoMoreThanTheBudgetForAnyCloud) {
  for (const std::uint64_t points : {1'000ull, 1'000'000ull, 100'000'000ull, 10'000'000'000ull}) {
    for (const std::uint64_t budget : {48 * kMega, 256 * kMega, 4096 * kMega}) {
      MemoryDemand demand = twenty_million();
      demand.points = points;
      try {
        EXPECT_LE(plan_memory(budget, normals_plan(), demand).expected_bytes, budget) << points;
      } catch (const Error& e) {
        EXPECT_NE(std::string(e.what()).find("--memory"), std::string::npos);
      }
    }
  }
}

TEST(MemoryPlan, NamesABudgetThatThenSuffices) {
  for (const std::size_t k : {8, 1000, 100'000}) {
    for (const std::uint64_t points : {1'000'000ull, 1'000'000'000ull}) {
      MemoryDemand demand = twenty_million();
      demand.points = points;
      std::uint64_t named = 0;
      try {
        plan_memory(kMega, normals_plan(k), demand);
        FAIL() << "one megabyte is not enough for anything";
      } catch (const Error& e) {
        const std::string text = e.what();
        named = std::stoull(text.substr(text.find("--memory ") + 9)) * kMega;
      }
      EXPECT_NO_THROW(plan_memory(named, normals_plan(k), demand)) << k << " of " << points << ": " << (named >> 20);
    }
  }
}

}  // namespace
}  // namespace pointsweep
