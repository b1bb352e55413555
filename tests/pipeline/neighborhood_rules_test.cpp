// SPDX-License-Identifier: MIT
// Neighbourhoods whose sizes differ from point to point, in the whole engine.
#include <gtest/gtest.h>

#include <algorithm>

#include "pointsweep/operators.h"
#include "pointsweep/operators/kinds/stage_operator.h"
#include "pointsweep/operators/statistics/neighbor_rows.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/pipeline/run/preview.h"
#include "tests/operators/chosen.h"
#include "tests/pipeline/hostile_clouds.h"
#include "tests/pipeline/in_memory.h"
#include "tests/pipeline/refusal.h"
#include "tests/support/brute_force.h"

namespace pointsweep {
namespace {

using Lists = std::vector<std::vector<std::uint32_t>>;
constexpr double kInf = std::numeric_limits<double>::infinity();

/// Points with the attributes "scale", from -2 to `most_k` and sometimes NaN, and "range", up to `most_range`.
struct Attributed {
  std::vector<Vec3> points;
  std::vector<double> xyz, scale, range;

  Attributed(const CloudShape& shape, std::size_t n, double most_k, double most_range, std::uint64_t seed)
      : points(make_cloud(shape, n, seed)) {
    std::mt19937_64 random(seed);
    for (const Vec3& p : points) {
      xyz.insert(xyz.end(), {p.x, p.y, p.z});
      const double u = uniform(random);
      scale.push_back(u < 0.02 ? std::numeric_limits<double>::quiet_NaN() : u < 0.04 ? kInf : -2 + u * (most_k + 2));
      range.push_back(u > 0.98 ? -1 : most_range * uniform(random));
    }
  }
  InputCloud cloud() const {
    auto reader = std::make_unique<ArrayReader>(std::span<const double>(xyz));
    reader->add({"scale"}, std::span<const double>(scale));
    reader->add({"range"}, std::span<const double>(range));
    std::vector<std::unique_ptr<Reader>> readers;
    readers.push_back(std::move(reader));
    return InputCloud(std::move(readers));
  }
  /// Returns the k nearest within `radius`, without the neighbours beyond a point's own limits.
  Lists lists(std::size_t k, double radius, bool by_scale, bool by_range) const {
    Lists out;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      const double own_k = by_scale ? scale[i] : kInf, own_radius = by_range ? range[i] : kInf;
      const std::size_t most = own_k >= 1 ? std::size_t(std::min(own_k, double(std::min(k, points.size())))) : 0;
      out.push_back(own_radius >= 0 ? brute_force_neighbors_of(points, i, most, std::min(radius, own_radius))
                                    : std::vector<std::uint32_t>{});
    }
    return out;
  }
};

/// Makes the largest neighbor_count of the neighbours and the point. The operator reads an attribute of neighbours.
class LargestCount final : public LocalOperator {
 public:
  std::string name() const override { return "largest_count"; }
  Contract contract() const override {
    const Attribute count = contract_of(operators::neighborhood_size()).makes[0];
    return {{count}, {count}, {scalar("largest", Type::u32, "1", "largest count around")}};
  }
  void apply(const Neighborhoods& in, Columns& out) const override {
    for (std::size_t i = 0; i < in.size(); ++i) {
      std::uint32_t most = in.value<std::uint32_t>(0, i);
      for (std::size_t j = 0; j < in.count(i); ++j) most = std::max(most, in.neighbor_value<std::uint32_t>(0, i, j));
      out.column<std::uint32_t>(0)[i] = most;
    }
  }
};

constexpr std::size_t kWritten = 12;  // number of neighbours of each point that are compared by row

void expect_lists(const RunResult& found, const std::vector<Vec3>& points, const Lists& expected) {
  const auto count = found.field("neighbor_count"), radius = found.field("neighbor_radius"),
             largest = found.field("largest");
  std::vector<std::vector<double>> neighbor;
  for (std::size_t j = 0; j < kWritten; ++j) neighbor.push_back(found.field("neighbor_" + std::to_string(j)));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::vector<std::uint32_t>& list = expected[i];
    ASSERT_EQ(count[i], double(list.size())) << i;
    ASSERT_EQ(radius[i], list.empty() ? 0 : std::sqrt(distance2(points[list.back()], points[i]))) << i;
    for (std::size_t j = 0; j < kWritten; ++j)
      ASSERT_EQ(neighbor[j][i], j < list.size() ? double(list[j]) : double(0xFFFFFFFFu)) << i << ", " << j;
    std::size_t most = list.size();
    for (const std::uint32_t j : list) most = std::max(most, expected[j].size());
    ASSERT_EQ(largest[i], double(most)) << i;
  }
}

/// Runs with different slabs, cells, threads and memory, and compares the lists. Adds the numbers of recalled points to
/// `recalled`.
void expect_everywhere(const Attributed& input, const Neighborhood& what, const Lists& expected,
                       std::uint64_t& recalled) {
  const std::size_t n = input.points.size();
  const Chain chain{what,
                    {std::make_shared<NeighborRows>(kWritten, n, false), operators::neighborhood_size(),
                     std::make_shared<LargestCount>()}};
  for (const auto& [slab, cell, threads] :
       {std::tuple<std::uint64_t, std::uint32_t, unsigned>{60, 16, 1}, {250, 64, 2}, {100000, 1024, 4}}) {
    SCOPED_TRACE("slabs of " + std::to_string(slab));
    InputCloud cloud = input.cloud();
    const RunResult result = run_in_memory(cloud, chain, small_slabs(slab, cell, threads, threads == 2));
    expect_lists(result, input.points, expected);
    if (testing::Test::HasFatalFailure()) return;
    recalled += result.statistics.recalled;
    EXPECT_EQ(result.statistics.certified + result.statistics.nonfinite, n);
  }
}

Neighborhood limited(std::size_t k, double radius, const AttributeLimits& limits) {
  return {.k = k, .radius = radius, .rule = operators::limits_from_attributes(limits)};
}

/// Returns a radius within which most points of the cloud have a few neighbours.
double typical(const std::vector<Vec3>& points) {
  std::vector<double> reach;
  for (std::uint32_t i = 0; i < points.size(); i += 50)
    if (const auto list = brute_force_neighbors_of(points, i, 20, kInf); !list.empty())
      reach.push_back(std::sqrt(distance2(points[list.back()], points[i])));
  std::nth_element(reach.begin(), reach.begin() + std::ptrdiff_t(reach.size() / 2), reach.end());
  return reach[reach.size() / 2];
}

TEST(NeighborhoodRules, OfAttributesEqualBruteForceOnHostileClouds) {
  std::uint64_t recalled = 0;
  for (const auto& [name, shape] : hostile_shapes()) {
    SCOPED_TRACE(name);
    const double reach = typical(make_cloud(shape, 1200, 21));
    const Attributed input(shape, 1200, 24, reach, 21);
    expect_everywhere(input, limited(16, kInf, {.k = "scale"}), input.lists(16, kInf, true, false), recalled);
    expect_everywhere(input, limited(80, reach, {.k = "scale", .radius = "range"}), input.lists(80, reach, true, true),
                      recalled);
    expect_everywhere(input, limited(Neighborhood::kUnlimited, reach, {.radius = "range"}),
                      input.lists(Neighborhood::kUnlimited, reach, false, true), recalled);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(recalled, 100u) << "the recall was not put to the test";
}

TEST(NeighborhoodRules, OfLeastEigenentropyEqualThoseOfTheWholeCloudInMemory) {
  std::uint64_t recalled = 0;
  const auto rule = operators::least_eigenentropy(6);
  for (const auto& [name, shape] : hostile_shapes()) {
    SCOPED_TRACE(name);
    const Attributed input(shape, 1200, 1, 1, 22);
    Lists expected = brute_force_neighbors(input.points, 24);
    const auto kept = chosen(*rule, input.points, expected);
    for (std::size_t i = 0; i < kept.size(); ++i) expected[i].resize(kept[i]);
    expect_everywhere(input, {.k = 24, .rule = rule}, expected, recalled);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(recalled, 100u) << "the recall was not put to the test";
}

TEST(NeighborhoodRules, ThatKeepAllGiveTheBytesOfNoRule) {
  const Attributed input(hostile_shapes()[0].second, 3000, 1, 1, 23);
  const auto rule = operators::limits_from_attributes({.k = "all"});
  const std::vector<double> all(input.points.size(), 1e9);
  const auto records = [&](const Neighborhood& what) {
    auto reader = std::make_unique<ArrayReader>(std::span<const double>(input.xyz));
    reader->add({"all"}, std::span<const double>(all));
    std::vector<std::unique_ptr<Reader>> readers;
    readers.push_back(std::move(reader));
    InputCloud cloud(std::move(readers));
    Chain chain = build_chain(parse_pipeline("normals | curvature | splats"), Facts{});
    chain.neighborhood = what;
    return run_in_memory(cloud, chain, small_slabs(250, 64, 2, true)).records;
  };
  EXPECT_EQ(records({.k = 12, .rule = rule}), records({.k = 12}));
}

TEST(NeighborhoodRules, ReadAttributesOfAnyTypeEvenCoordinates) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes()[1].second, 800, 24);
  std::vector<float> xyz, few;
  for (const Vec3& p : points) {
    xyz.insert(xyz.end(), {float(p.x), float(p.y), float(p.z)});
    few.push_back(float(xyz.size() % 7));
  }
  auto reader = std::make_unique<ArrayReader>(std::span<const float>(xyz));
  reader->add({"few"}, std::span<const float>(few));
  std::vector<std::unique_ptr<Reader>> readers;
  readers.push_back(std::move(reader));
  InputCloud cloud(std::move(readers));
  for (const Order order : {Order::input, Order::sweep}) {
    EngineOptions options = small_slabs(100, 32, 2, true);
    options.order = order;
    const auto stages = parse_pipeline("knn(k=8, k_from=few, radius_from=z) | neighborhood_size");
    const RunResult result = run_in_memory(cloud, build_chain(stages, cloud), options);
    const auto count = result.field("neighbor_count"), radius = result.field("neighbor_radius"),
               limit = result.field("few"), z = result.field("z");
    double most = 0;
    for (std::size_t i = 0; i < count.size(); ++i) {
      EXPECT_LE(count[i], limit[i]);
      EXPECT_LE(radius[i], z[i]);
      most = std::max(most, count[i]);
    }
    EXPECT_EQ(most, 6);
  }
}

TEST(NeighborhoodRules, OfALaterSweepReadWhatAnEarlierOneMade) {
  const Attributed input(hostile_shapes()[0].second, 1500, 1, 1, 27);
  const auto normals_of = [&](const std::string& pipeline) {
    InputCloud cloud = input.cloud();
    Chain chain = build_chain(parse_pipeline(pipeline), cloud);
    chain.keep = {"normal"};
    return run_in_memory(cloud, chain, small_slabs(250, 64, 2, true)).records;
  };
  const auto adaptive = normals_of("knn(k=40, adaptive=eigenentropy) | normals");
  EXPECT_EQ(normals_of("knn(k=40, adaptive=eigenentropy) | neighborhood_size | "
                       "reneighbor(k=40, k_from=neighbor_count) | normals"),
            adaptive);
  EXPECT_EQ(normals_of("knn(k=5) | reneighbor(k=40, adaptive=eigenentropy) | normals"), adaptive);
  EXPECT_EQ(normals_of("knn(k=40, adaptive=eigenentropy) | reneighbor | normals"), adaptive);
  EXPECT_NE(normals_of("knn(k=40) | normals"), adaptive);
}

TEST(NeighborhoodRules, AnAttributeThatTheInputLacksIsRefusedWithWhatItHas) {
  const Attributed input(hostile_shapes()[0].second, 10, 1, 1, 25);
  InputCloud cloud = input.cloud();
  const std::string sentence = refusal(
      [&] { plan_chain(build_chain(parse_pipeline("knn(k=8, k_from=scales) | normals"), cloud), cloud.schema()); });
  EXPECT_EQ(sentence,
            "The neighbours are to be as many as 'scales' says, but the input has no attribute 'scales'; it has x, y, "
            "z, scale, range.");
}

TEST(NeighborhoodRules, AnArrayOfTheInputIsRefusedAsALimit) {
  Schema input;
  for (const char* axis : {"x", "y", "z"}) input.append(axis, Type::f64);
  input.append("scales", Type::u8, 3);
  for (const char* pipeline : {"knn(k=8, k_from=scales) | normals", "knn(k=8, radius_from=scales) | normals"})
    EXPECT_NE(refusal([&] {
                plan_chain(build_chain(parse_pipeline(pipeline), Facts{}), input);
              }).find(", but 'scales' is an array of 3, not a single value."),
              std::string::npos)
        << pipeline;
}

TEST(NeighborhoodRules, ThePreviewSaysWhatIsKeptAndWhatItReads) {
  const Attributed input(hostile_shapes()[0].second, 1000, 1, 1, 26);
  InputCloud cloud = input.cloud();
  const auto text_of = [&](const char* pipeline) {
    return to_text(preview(cloud, build_chain(parse_pipeline(pipeline), cloud)));
  };
  const std::string limits = text_of("knn(k=64, k_from=scale, radius_from=range) | normals");
  EXPECT_NE(limits.find("the 64 nearest; of these as many as 'scale' says, those within 'range'"), limits.npos)
      << limits;
  EXPECT_NE(limits.find("scale                 8  the file        step 1"), limits.npos) << limits;
  const std::string adaptive = text_of("knn(k=64, adaptive=eigenentropy, k_min=12) | normals");
  EXPECT_NE(adaptive.find("the 64 nearest; of these the first 12 or more with the least eigenentropy"), adaptive.npos)
      << adaptive;
}

}  // namespace
}  // namespace pointsweep
