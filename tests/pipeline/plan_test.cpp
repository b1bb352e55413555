// SPDX-License-Identifier: MIT
/// The one plan of a chain: its graph, its passes, what a point takes in them, and the phases of the run.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <random>

#include "pointsweep/error.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/surface/normals.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/pipeline/memory/run_memory.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/pipeline/run/phases.h"
#include "pointsweep/threads.h"
#include "tests/pipeline/dense_ball.h"
#include "tests/pipeline/in_memory.h"

namespace pointsweep {
namespace {

Schema positions_and_level() {
  Schema schema;
  for (const char* name : {"x", "y", "z"}) schema.append(name, Type::f32);
  schema.append("level", Type::u16);
  return schema;
}

ChainPlan plan_of(const std::string& text, bool ordered = false, const std::vector<std::string>& keep = {}) {
  Chain chain = build_chain(parse_pipeline(text), Facts{.points = 1000});
  chain.keep = keep;
  return plan_chain(chain, positions_and_level(), {.stream_order = ordered});
}

/// Returns a letter for the kind of each node, in the order of the graph.
std::string kinds_of(const ChainPlan& plan) {
  std::string kinds;
  for (const GraphNode& node : plan.graph.nodes)
    kinds += node.neighborhood() != nullptr ? 'n'
             : node.reduction() != nullptr  ? 'r'
             : node.is_order()              ? 'o'
             : node.drops_rows()            ? 'l'
                                            : 's';
  return kinds;
}

/// Returns the index of the version of an attribute that the node `producer` makes, or that the input has.
std::size_t version_of(const ChainGraph& graph, const std::string& name, std::optional<std::size_t> producer) {
  for (std::size_t v = 0; v < graph.versions.size(); ++v)
    if (graph.versions[v].attribute.name == name && graph.versions[v].producer == producer) return v;
  throw Error("no such version of " + name);
}

bool has(const std::vector<std::size_t>& versions, std::size_t version) {
  return std::ranges::find(versions, version) != versions.end();
}

TEST(ChainGraph, HasANodeOfItsKindForEveryPartOfAChain) {
  EXPECT_EQ(kinds_of(plan_of("normals")), "ns");
  EXPECT_EQ(kinds_of(plan_of("normals | splats | fair | reneighbor | normals")), "nssrsns");
  EXPECT_EQ(kinds_of(plan_of("sor | where(outlier == 0) | resort")), "nsrslo");
  EXPECT_EQ(kinds_of(plan_of("unique | normals")), "nls");
}

TEST(ChainGraph, KnowsWhichVersionEachStageReadsAndWhichIsWritten) {
  const ChainGraph graph = plan_of("normals | curvature | splats | normals | curvature").graph;
  const std::size_t first = version_of(graph, "normal", 1), second = version_of(graph, "normal", 4);
  for (std::size_t n = 0; n < graph.nodes.size(); ++n) {
    const auto reads = [&](std::size_t version) {
      return has(graph.nodes[n].reads, version) || has(graph.nodes[n].reads_neighbors, version);
    };
    EXPECT_TRUE(!reads(first) || n == 2 || n == 3) << n;
    EXPECT_EQ(reads(second), n == 5) << n;
  }
  EXPECT_TRUE(has(graph.nodes[5].reads_neighbors, second));
  EXPECT_FALSE(has(graph.made, first));
  EXPECT_TRUE(has(graph.made, second));
}

TEST(ChainGraph, AVersionOfTheInputHasNoProducer) {
  const ChainGraph graph = plan_of("where(level == 2) | normals").graph;
  EXPECT_TRUE(has(graph.nodes[1].reads, version_of(graph, "level", std::nullopt)));
}

TEST(ChainGraph, StagesThatNeedOneValueOfTheSameRowsShareItsNode) {
  const auto reduces = [](const std::string& text) {
    const std::string kinds = kinds_of(plan_of(text));
    return std::count(kinds.begin(), kinds.end(), 'r');
  };
  EXPECT_EQ(reduces("normals | splats | fair | normals | splats | fair"), 1);
  EXPECT_EQ(reduces("normals | splats | fair | reneighbor | normals | splats | fair"), 1);
  EXPECT_EQ(reduces("normals | splats | fair | where(z > 0) | normals | splats | fair"), 2) << "of other rows";
  EXPECT_EQ(reduces("sor | sor(multiplier=1)"), 2) << "of another version";
}

TEST(ChainPlan, AChainThatBeginsWithNewNeighborsFindsValuesOfTheInputBeforeTheSweep) {
  const ChainPlan plan = plan_of("reneighbor | normals | splats | fair");
  ASSERT_EQ(plan.passes.size(), 2u);
  EXPECT_EQ(plan.passes[0].kind, PassKind::rows);
  EXPECT_EQ(plan.passes[1].kind, PassKind::sweep);
}

/// Positions in float32 take 12 bytes, a number of neighbours 4, a distance 8.
TEST(ChainPlan, CountsWhatAPointTakesInTheStreamAndBetweenPasses) {
  const ChainPlan plan = plan_of("sor | where(outlier == 0 && level > 3) | normals");
  ASSERT_EQ(plan.passes.size(), 3u);
  EXPECT_EQ(plan.passes[0].travelling_bytes(), 12u) << "positions only";
  EXPECT_EQ(plan.passes[0].carried_bytes(), 8u) << "mean_distance";
  EXPECT_EQ(plan.passes[1].carried_bytes(), 8u + 1) << "and outlier";
  EXPECT_TRUE(plan.leaves_rows(0) && plan.leaves_rows(1) && !plan.leaves_rows(2));
  EXPECT_EQ(plan.most_carried_bytes(), 8u + 9);
  EXPECT_EQ(plan_of("normals | splats").most_carried_bytes(), 0u);
}

TEST(ChainPlan, SaysOfEveryColumnWhoMakesItAndHowLongItIsNeeded) {
  const ChainPlan plan = plan_of("sor | normals | curvature", false, {"mean_curvature", "outlier"});
  const PlannedPass& sweep = plan.passes.front();
  ASSERT_EQ(sweep.columns.size(), sweep.plan.column_bytes.size());
  for (std::size_t c = 0; c < sweep.columns.size(); ++c) {
    const ColumnPlan& column = sweep.columns[c];
    EXPECT_EQ(column.bytes, sweep.plan.column_bytes[c]);
    const bool normal = column.attribute == "normal";
    EXPECT_EQ(column.written, column.attribute == "mean_distance" || column.attribute == "mean_curvature")
        << column.attribute;
    EXPECT_EQ(column.made_by == "2 normals", normal);
    EXPECT_TRUE(!normal || sweep.plan.lifetimes[c] == Lifetime::cell) << "curvature reads it of neighbours";
  }
  EXPECT_EQ(plan.passes.back().columns.front().made_by, "a pass before");
}

/// An operator that counts how often a chain is bound to a schema.
class CountsBindings final : public LocalOperator {
 public:
  explicit CountsBindings(int& count) : count_(count) {}
  std::string name() const override { return "counts_bindings"; }
  Contract contract() const override { return {{}, {}, {scalar("one", Type::f32, "1", "")}}; }
  void apply(const Neighborhoods&, Columns&) const override {}
  std::shared_ptr<const LocalOperator> bound(const Schema&, std::span<const Attribute>) const override {
    ++count_;
    return nullptr;
  }

 private:
  int& count_;
};

TEST(ChainPlan, IsMadeOnceForARunHoweverManyPassesItHas) {
  int count = 0;
  EngineOptions options;
  options.order = Order::sweep;
  const Chain chain{{.k = 3},
                    {std::make_shared<CountsBindings>(count), operators::sor(), Reneighbor(),
                     std::make_shared<Normals>(), operators::unique()}};
  run_in_memory(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}}, chain, options);
  EXPECT_EQ(count, 1);
}

/// Normals, then normals of neighbourhoods whose size it leaves to its parts.
class UnnamedNeighbors final : public CompositeOperator {
 public:
  std::string name() const override { return "unnamed"; }
  Contract contract() const override { return Normals().contract(); }
  std::vector<ChainStage> parts() const override {
    return {std::make_shared<Normals>(), Reneighbor(Neighborhood{.k = Neighborhood::kOfOperators}),
            std::make_shared<Normals>()};
  }
};

TEST(ChainPlan, RefusesACompositeThatNamesNoNeighborsForItsReneighbor) {
  const Chain chain{{.k = 3}, {std::make_shared<UnnamedNeighbors>()}};
  try {
    plan_chain(with_named_neighborhoods(chain), positions_and_level(), {});
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_STREQ(error.what(), "unnamed: states no k for the Reneighbor inside it; set Neighborhood::k there.");
  }
}

std::string phases_text(const ChainPlan& plan) {
  std::string text;
  for (const Phase& phase : phases_of(plan))
    text += fmt::format("{}{}{}", text.empty() ? "" : " ", "SOWUT"[static_cast<std::size_t>(phase.kind)], phase.pass);
  return text;
}

/// Letters: S survey, O order, W sweep, U update, T write; numbers are passes.
TEST(Phases, OfARunFollowFromItsPlan) {
  EXPECT_EQ(phases_text(plan_of("normals")), "S0 O0 W0 T0");
  EXPECT_EQ(phases_text(plan_of("normals", true)), "S0 O0 W0 T0");
  EXPECT_EQ(phases_text(plan_of("where(z > 0)")), "S0 U0 T1");
  EXPECT_EQ(phases_text(plan_of("where(z > 0) | normals", true)), "S0 U0 O1 W1 T1") << "the sweep has the order";
  EXPECT_EQ(phases_text(plan_of("sor", true)), "S0 O0 W0 U0 U1 O2 T2");
  EXPECT_EQ(phases_text(plan_of("sor | where(outlier == 0) | normals")), "S0 O0 W0 U0 U1 O2 W2 T2");
  EXPECT_EQ(phases_text(plan_of("normals | splats | fair | reneighbor | normals")), "S0 U0 O1 W1 U1 O2 W2 T2");
  ChainPlan sort;
  sort.reorders = true;
  EXPECT_EQ(phases_text(sort), "S0 O0 T0");
}

/// Returns the survey of a unit cube.
Survey survey_of() {
  Survey survey;
  survey.bounds.include(Vec3{0, 0, 0}), survey.bounds.include(Vec3{1, 1, 1});
  survey.exact = true;
  return survey;
}

TEST(RunMemory, CountsRowsAndMasksBetweenPassesOnce) {
  constexpr std::uint64_t kPoints = 10'000'000;
  const auto memory = [&](const std::string& text, std::uint64_t budget, bool ordered = false) {
    EngineOptions options;
    options.resources.threads = 2;
    options.order = ordered ? Order::sweep : Order::input;
    return plan_run_memory(budget, plan_of(text, ordered), kPoints, survey_of(), options, 40);
  };
  const RunMemory none = memory("normals", 8192 * kMega);
  EXPECT_EQ(none.row_bytes, 0u);
  EXPECT_FALSE(none.spills());
  const char* chain = "sor | where(outlier == 0) | normals";
  const RunMemory all = memory(chain, 8192 * kMega);
  EXPECT_FALSE(all.spills());
  EXPECT_GE(all.row_bytes, kPoints * (8 + 9) + 2 * kPoints / 8) << "mean_distance and outlier, and a bit in each mask";
  EXPECT_LE(all.row_bytes, kPoints * (8 + 9) + 2 * kPoints / 8 + kPoints / 100);
  std::uint64_t most = 0;
  for (const MemoryPlan& pass : all.passes) most = std::max(most, pass.expected_bytes);
  EXPECT_EQ(all.expected_bytes, most + all.row_bytes);
  for (const bool ordered : {false, true}) {
    const RunMemory tight = memory(chain, 96 * kMega, ordered);
    EXPECT_TRUE(tight.spill_rows && tight.spills());
    EXPECT_LE(tight.expected_bytes, 96 * kMega);
    EXPECT_EQ(tight.row_bytes, memory(chain, 8192 * kMega, ordered).row_bytes) << "in the temporary folder now";
  }
}

TEST(RunMemory, CountsWhatDecodingAndEncodingTakeInEveryPass) {
  EngineOptions options;
  options.resources.threads = 2;
  constexpr std::uint64_t kPoints = 1'000'000, kCodecs = 10 * kMega;
  for (const char* chain : {"normals", "sor | where(outlier == 0) | normals", "where(z > 0)"}) {
    const auto expected = [&](std::uint64_t codecs) {
      return plan_run_memory(8192 * kMega, plan_of(chain), kPoints, survey_of(), options, 40,
                             [codecs](unsigned) { return codecs; });
    };
    const RunMemory without = expected(0), with = expected(kCodecs);
    for (std::size_t p = 0; p < with.passes.size(); ++p)
      EXPECT_EQ(with.passes[p].expected_bytes, without.passes[p].expected_bytes + kCodecs) << chain << ", pass " << p;
  }
  const auto codecs = [](unsigned) { return kCodecs; };
  EXPECT_THROW(plan_run_memory(32 * kMega, plan_of("normals"), kPoints, survey_of(), options, 40, codecs), Error);
}

TEST(RunMemory, FewerThreadsSurveyInASmallBudget) {
  const std::vector<double> xyz = {1, 2, 3};
  std::vector<std::unique_ptr<Reader>> readers;
  readers.push_back(std::make_unique<ArrayReader>(std::span<const double>(xyz)));
  const InputCloud cloud(std::move(readers));
  const auto threads = [&](std::uint64_t mega, unsigned asked) {
    EngineOptions options;
    options.resources = {.memory_bytes = mega * kMega, .threads = asked};
    return survey_threads(cloud, options);
  };
  EXPECT_EQ(threads(1, 64), 1u);
  EXPECT_EQ(threads(32, 64), 4u) << "half a MB each, in a quarter of what is left beside what any run takes";
  EXPECT_EQ(threads(32, 2), 2u);
  EXPECT_EQ(threads(64, 64), 20u);
  EXPECT_EQ(threads(256, 64), 64u);
}

TEST(RunMemory, FewerThreadsWorkWhereTheBudgetHasNoRoomForAll) {
  const auto memory = [](const char* chain, std::uint64_t mega, unsigned threads) {
    EngineOptions options;
    options.resources.threads = threads;
    return plan_run_memory(mega * kMega, plan_of(chain), 20'000'000, survey_of(), options, 40,
                           [](unsigned working) { return working * (kMega / 4); });
  };
  const auto least = [&](const char* chain, unsigned threads) {
    try {
      memory(chain, 1, threads);
    } catch (const Error& e) {
      const std::string sentence = e.what();
      return std::stoull(sentence.substr(sentence.find("--memory ") + 9));
    }
    return 0ULL;
  };
  for (const char* chain : {"normals", "sor | where(outlier == 0) | normals", "normals | splats | fair", "level"}) {
    const std::uint64_t least_of_one = least(chain, 1);
    EXPECT_GT(least_of_one, 32u);
    EXPECT_EQ(least(chain, 64), least_of_one) << "one thread is enough for any number that is asked for";
    EXPECT_EQ(memory(chain, least_of_one, 1).threads_note, "");
    unsigned before = 1;
    for (std::uint64_t mega = least_of_one; mega < 4096; mega += mega / 8) {
      const RunMemory planned = memory(chain, mega, 64);
      EXPECT_LE(planned.expected_bytes, mega * kMega);
      EXPECT_GE(planned.threads, before) << "a larger budget never has room for fewer";
      before = planned.threads;
      if (planned.threads == 64) {
        EXPECT_EQ(planned.threads_note, "");
        continue;
      }
      EXPECT_NE(memory(chain, mega, planned.threads + 1).threads_note, "") << "as many as fit";
      const std::string& note = planned.threads_note;
      const std::string begin =
          fmt::format("{} of 64 threads work: a memory budget of {} MB has", planned.threads, mega);
      EXPECT_EQ(note.find(begin), 0u) << note;
      const std::uint64_t enough = std::stoull(note.substr(note.find("--memory ") + 9));
      EXPECT_EQ(memory(chain, enough, 64).threads, 64u);
      EXPECT_LT(memory(chain, enough - 1, 64).threads, 64u);
    }
    EXPECT_EQ(before, 64u);
  }
}

TEST(RunMemory, IsThatOfTheThreadsThatWillWorkHoweverManyPlan) {
  for (const char* chain : {"level", "ground | height", "poisson(0.1)"}) {
    std::vector<std::uint64_t> expected;
    for (const unsigned planning : {1u, 7u}) {
      with_threads(planning, [&] {
        EngineOptions options;
        options.resources.threads = 3;
        const RunMemory planned = plan_run_memory(512 * kMega, plan_of(chain), 20'000'000, survey_of(), options, 40);
        expected.push_back(planned.expected_bytes);
      });
    }
    EXPECT_EQ(expected[0], expected[1]) << chain;
  }
}

TEST(RunMemory, WithoutALimitKThreadsNeedNotLeaveMemoryToARecall) {
  EngineOptions options;
  options.resources.threads = 64;
  const auto memory = [&](const char* chain, std::uint64_t mega) {
    return plan_run_memory(mega * kMega, plan_of(chain), 20'000'000, survey_of(), options, 40);
  };
  EXPECT_GT(memory("normals", 4096).passes.front().threads_bytes, 0u);
  const RunMemory within = memory("knn(radius=0.001) | normals", 2048);
  EXPECT_EQ(within.passes.front().threads_bytes, 0u);
  EXPECT_EQ(within.threads, 64u) << "which take more than a quarter";
}

Survey survey_of_surface() {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> share(0, 1);
  Survey survey;
  for (std::size_t i = 0; i < 20'000; ++i) {
    survey.sample.push_back({share(random), share(random), 0});
    survey.bounds.include(survey.sample.back());
  }
  survey.dimension = box_counting_dimension(survey.sample);
  return survey;
}

TEST(RunMemory, CountsThePointsThatSeveralStepsKeepInUnevenDensity) {
  const ChainPlan chain = plan_of("knn(k=64) | normals | splats | fair(f=0.3, g=0.3) | normals");
  const auto is_enough = [&](std::uint64_t mega, const Survey& survey) {
    EngineOptions options;
    options.resources.threads = 2;
    try {
      plan_run_memory(mega * kMega, chain, 1'000'000, survey, options, 40);
      return true;
    } catch (const Error&) {
      return false;
    }
  };
  EXPECT_TRUE(is_enough(75, survey_of_surface()));
  EXPECT_FALSE(is_enough(75, survey_of_dense_ball())) << "the window of such a cloud took 50 MB";
  EXPECT_TRUE(is_enough(130, survey_of_dense_ball()));
}

TEST(RunMemory, WithRowsBetweenPassesNeverExpectsMoreThanTheBudget) {
  for (const char* chain : {"where(z > 0) | normals", "sor | where(outlier == 0) | normals | splats | fair",
                            "unique | normals | where(nz > 0)", "normals | splats | fair | reneighbor | normals"}) {
    for (std::uint64_t mega = 32; mega < 4096; mega += mega / 3) {
      try {
        EngineOptions options;
        options.resources.threads = 2;
        const RunMemory memory =
            plan_run_memory(mega * kMega, plan_of(chain), 20'000'000, survey_of_surface(), options, 40);
        EXPECT_LE(memory.expected_bytes, mega * kMega) << chain;
        for (const MemoryPlan& pass : memory.passes) EXPECT_LE(pass.expected_bytes, mega * kMega) << chain;
      } catch (const Error& e) {
        EXPECT_NE(std::string(e.what()).find("--memory"), std::string::npos) << e.what();
        EXPECT_LT(mega, 128u) << chain;
      }
    }
  }
}

}  // namespace
}  // namespace pointsweep
