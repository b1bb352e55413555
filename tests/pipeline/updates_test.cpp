// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <numeric>
#include <tuple>

#include "pointsweep/operators/surface/splats.h"
#include "pointsweep/pipeline/run/preview.h"
#include "tests/pipeline/moving_clouds.h"
#include "tests/pipeline/refusal.h"
#include "tests/support/sized.h"
#include "tests/support/watching.h"

namespace pointsweep {
namespace {

TEST(Updates, TheBytesDependNeitherOnThreadsNorSlabsNorMemory) {
  const Stages stages = {thrown(1), resort(), reneighbor(), normals(), thrown(0.5, 4)};
  for (const Order order : {Order::input, Order::sweep}) {
    for (const auto& [name, shape] : hostile_shapes()) {
      SCOPED_TRACE(name + (order == Order::input ? ", input order" : ", sweep order"));
      const std::vector<Vec3> points = make_cloud(shape, sized(600), 31);
      std::vector<std::byte> first;
      for (const unsigned threads : {1u, 2u, 4u}) {
        for (const std::uint64_t slab : {100, 50'000}) {
          for (const bool spill : {false, true}) {
            EngineOptions options = tiny(slab, spill, threads);
            options.order = order;
            const RunResult result = run_in_memory(points, {{.k = 6}, stages}, options);
            ASSERT_EQ(result.statistics.bytes_spilled > 0, spill);
            if (first.empty()) first = result.records;
            ASSERT_EQ(result.records, first) << threads << " threads, slabs of " << slab;
          }
        }
      }
    }
  }
}

/// Returns the rows in canonical order along `axis` (negative: the longest axis of the finite points). Points that are
/// not finite come last.
std::vector<std::uint32_t> canonical_rows(const std::vector<Vec3>& points, int axis) {
  Box box;
  for (const Vec3& p : points)
    if (is_finite(p)) box.include(p);
  if (axis < 0) axis = box.longest_axis();
  std::vector<std::uint32_t> rows(points.size());
  std::iota(rows.begin(), rows.end(), 0u);
  std::sort(rows.begin(), rows.end(), [&](std::uint32_t a, std::uint32_t b) {
    const Vec3 p = points[a], q = points[b];
    if (!is_finite(p) || !is_finite(q)) return is_finite(p) != is_finite(q) ? is_finite(p) : a < b;
    return std::tuple(p[axis], p.x, p.y, p.z, a) < std::tuple(q[axis], q.x, q.y, q.z, b);
  });
  return rows;
}

/// Returns the records of `by_row` in the order `rows`.
std::vector<std::byte> permuted(const RunResult& by_row, const std::vector<std::uint32_t>& rows) {
  std::vector<std::byte> records;
  for (const std::uint32_t row : rows) {
    const auto at = by_row.records.begin() + std::ptrdiff_t(row * by_row.schema.stride);
    records.insert(records.end(), at, at + by_row.schema.stride);
  }
  return records;
}

TEST(Resort, OrdersTheOutputByThePositionsAtItsPlaceAndChangesNoValue) {
  const Throw first(2, 1), second(7, 2);
  const auto a = std::make_shared<Throw>(first), b = std::make_shared<Throw>(second);
  for (const auto& [name, shape] : hostile_shapes()) {
    const std::vector<Vec3> points = make_cloud(shape, 300, 32);
    std::vector<Vec3> once, twice;
    for (const Vec3& p : points) once.push_back(is_finite(p) ? first.moved(p, once.size()) : p);
    // Within one sweep, the second operator also moves points that the first has made not finite.
    for (std::size_t i = 0; i < points.size(); ++i)
      twice.push_back(is_finite(points[i]) ? second.moved(once[i], i) : points[i]);
    const std::vector<std::tuple<std::string, Stages, std::vector<Vec3>>> chains = {
        {"no update", {a, normals()}, points},
        {"before any move", {resort(), a, normals()}, points},
        {"last", {a, normals(), resort()}, once},
        {"then moved again", {a, resort(), b, normals()}, once},
        {"the later one counts", {a, resort(), b, resort()}, twice},
        {"then new neighbours", {a, resort(), reneighbor(), normals()}, once},
        {"after new neighbours", {normals(), a, reneighbor(4), resort(), normals()}, once},
        {"new neighbours only", {a, reneighbor(), normals()}, points},
    };
    for (const auto& [what, stages, key] : chains) {
      const RunResult by_row = run_in_memory(points, {{.k = 5}, stages}, tiny(150));
      for (const int axis : {-1, 1}) {
        SCOPED_TRACE(fmt::format("{}: {}, axis {}", name, what, axis));
        EngineOptions options = tiny(90, axis == 1);
        options.order = Order::sweep;
        if (axis >= 0) options.axis = axis;
        const RunResult ordered = run_in_memory(points, {{.k = 5}, stages}, options);
        ASSERT_EQ(ordered.schema, by_row.schema);
        ASSERT_EQ(ordered.records, permuted(by_row, canonical_rows(key, axis)));
      }
    }
  }
}

TEST(Resort, ChangesNothingInTheOrderOfTheInput) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes()[10].second, 800, 33);
  const RunResult plain = run_in_memory(points, {{.k = 5}, {thrown(3), normals()}}, tiny(100));
  const RunResult sorted = run_in_memory(points, {{.k = 5}, {thrown(3), resort(), normals()}}, tiny(100));
  EXPECT_EQ(sorted.records, plain.records);
  EXPECT_EQ(sorted.schema, plain.schema);
  EXPECT_EQ(sorted.statistics.sweeps, 1u);
}

TEST(Resort, IsTheOrderThatSortGivesAFileOfTheMovedPositions) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes()[0].second, 900, 34);
  EngineOptions options = tiny(100);
  options.order = Order::sweep;
  const RunResult resorted = run_in_memory(points, {{.k = 5}, {thrown(3), resort()}}, options);
  std::vector<Vec3> moved;
  for (const Vec3& p : points) moved.push_back(Throw(3).moved(p, moved.size()));
  std::vector<double> xyz;
  for (const Vec3& p : moved) xyz.insert(xyz.end(), {p.x, p.y, p.z});
  const auto cloud = cloud_of(std::make_unique<ArrayReader>(std::span<const double>(xyz)));
  const auto path = std::filesystem::temp_directory_path() / fmt::format("resorted-{}.ply", ::getpid());
  options.overwrite = true;
  sort(*cloud, path, options);
  const auto sorted = open_reader(path);
  std::vector<std::byte> records(points.size() * sorted->info().schema.stride);
  ASSERT_EQ(sorted->read(0, records), points.size());
  std::filesystem::remove(path);
  EXPECT_EQ(resorted.records, records);
}

TEST(Updates, ChainsThatDoNotFitAreRefusedBeforeAnyWork) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes()[0].second, 50, 1);
  const auto sentence = [&](const Chain& chain) { return refusal([&] { run_in_memory(points, chain, {}); }); };
  EXPECT_NE(sentence({{}, {thrown(1), reneighbor(), std::make_shared<Splats>(SplatsOptions{})}})
                .find("splats: needs 'normal'"),
            std::string::npos);
  EXPECT_NE(sentence({{}, {thrown(1), reneighbor(0), normals()}}).find("k = 0 gives no neighbours"), std::string::npos);
  EXPECT_NE(sentence({{}, {reneighbor(), resort()}}).find("computes nothing; add an operator"), std::string::npos);
  EXPECT_NE(sentence({{}, {thrown(1), reneighbor(), normals()}, {"stream_position"}})
                .find("what is made is position, normal."),
            std::string::npos);
  EXPECT_NE(refusal([] { chain_of("normals | reneighbor(n=3)"); }).find("reneighbor has no option 'n'"),
            std::string::npos);
  EXPECT_NE(refusal([] { chain_of("normals | resort(axis=1)"); }).find("resort has no options"), std::string::npos);
  EXPECT_NE(refusal([] { chain_of("normals | knn(k=9) | normals"); }).find("from here on write reneighbor(k=9)."),
            std::string::npos);
}

/// Returns the budget in bytes that the refusal of a run in one megabyte names.
std::uint64_t least_budget(const std::vector<Vec3>& points, const Chain& chain) {
  EngineOptions options;
  options.resources.memory_bytes = 1 << 20;
  try {
    run_in_memory(points, chain, options);
  } catch (const Error& e) {
    const std::string text = e.what();
    return std::stoull(text.substr(text.find("--memory ") + 9)) << 20;
  }
  return 0;
}

TEST(Updates, ABudgetThatALaterSweepCannotKeepIsRefusedBeforeTheFirst) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes()[0].second, 20'000, 2);
  const Chain chain{{.k = 4}, {thrown(1), reneighbor(19'000), graph(1, 20'000), thrown(1, 2)}};
  EngineOptions options;
  options.resources.memory_bytes =
      least_budget(points, {{.k = 4}, {thrown(1), graph(1, 20'000)}});  // suffices for the first sweep
  std::string phases;
  Watching watching([&](const Progress& p) { phases += p.phase; });
  options.observer = &watching;
  try {
    run_in_memory(points, chain, options);
    FAIL() << "accepted";
  } catch (const Error& e) {
    const std::string text = e.what();
    ASSERT_NE(text.find("is too small"), std::string::npos) << text;
    options.resources.memory_bytes = std::stoull(text.substr(text.find("--memory ") + 9)) << 20;
  }
  EXPECT_EQ(phases, "");
  std::vector<double> xyz;
  for (const Vec3& p : points) xyz.insert(xyz.end(), {p.x, p.y, p.z});
  const auto cloud = cloud_of(std::make_unique<ArrayReader>(std::span<const double>(xyz)));
  EXPECT_NO_THROW(preview(*cloud, chain, options)) << "the budget named suffices for all sweeps";
}

TEST(Updates, ReportEveryPhase) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes()[0].second, 500, 3);
  EngineOptions options = tiny(100);
  options.order = Order::sweep;
  std::string phases, last;
  std::uint64_t done = 0;
  Watching watching([&](const Progress& p) {
    if (p.phase != last) phases += std::string(phases.empty() ? "" : " ") + p.phase;
    EXPECT_TRUE(p.phase != last || p.done >= done) << p.phase;
    EXPECT_LE(p.done, p.total);
    last = p.phase, done = p.done;
  });
  options.observer = &watching;
  run_in_memory(points, {{.k = 5}, {thrown(1), reneighbor(), normals()}}, options);
  EXPECT_EQ(phases, "ordering sweeping updating ordering sweeping updating ordering writing");
}

TEST(Updates, ThePreviewTellsTheSweepsApart) {
  std::vector<double> xyz;
  for (const Vec3& p : make_cloud(hostile_shapes()[0].second, 300, 4)) xyz.insert(xyz.end(), {p.x, p.y, p.z});
  const auto cloud = cloud_of(std::make_unique<ArrayReader>(std::span<const double>(xyz)));
  Chain chain{{.k = 5},
              {normals(), thrown(1), resort(), reneighbor(9),
               std::make_shared<Normals>(NormalsOptions{.orient = Orient::input, .viewpoint = {}})}};
  EngineOptions options = tiny(100);
  options.order = Order::sweep;
  const std::string text = to_text(preview(*cloud, chain, options));
  for (const char* words : {"pass 1 of 2\nneighbours    the 5 nearest", "pass 2 of 2\nneighbours    the 9 nearest",
                            "  1 normals", "  2 throw", "  3 resort", "  4 normals",
                            "carried on    60 bytes a point: normal (nx ny nz float32) position (x y z float64)",
                            "a pass before", "results       36 bytes a point", "order         of the moved positions",
                            "MB between passes", "3 resort       1  through"})
    EXPECT_NE(text.find(words), std::string::npos) << words << "\n" << text;
}

}  // namespace
}  // namespace pointsweep
