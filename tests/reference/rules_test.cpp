// SPDX-License-Identifier: MIT
// Neighbourhoods whose sizes differ from point to point in the reference engine, against brute force and the exact
// engine.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pointsweep/operators.h"
#include "pointsweep/operators/surface/normals.h"
#include "tests/reference/reference_runs.h"
#include "tests/support/brute_force.h"

namespace pointsweep {
namespace {

constexpr std::size_t kMost = 24;
constexpr double kInf = std::numeric_limits<double>::infinity();

/// A cloud with the attributes "size" (f64) and "range" (f32), some of which are no limits.
struct Attributed {
  std::vector<Vec3> points;
  std::vector<double> xyz, size;
  std::vector<float> range;

  Attributed(const CloudShape& shape, std::size_t n) : points(make_cloud(shape, n, 31)), xyz(xyz_of(points)) {
    std::mt19937_64 random(31);
    const double extent = length(bounds_of(points).extent());
    for (std::size_t i = 0; i < n; ++i) {
      const double u = uniform(random);
      size.push_back(u < 0.02 ? std::numeric_limits<double>::quiet_NaN() : u < 0.04 ? kInf : -2 + 30 * u);
      range.push_back(u > 0.98 ? -1 : float(0.1 * extent * uniform(random)));
    }
  }
  InputCloud cloud() const {
    auto reader = std::make_unique<ArrayReader>(std::span<const double>(xyz));
    reader->add({"size"}, std::span<const double>(size));
    reader->add({"range"}, std::span<const float>(range));
    std::vector<std::unique_ptr<Reader>> readers;
    readers.push_back(std::move(reader));
    return InputCloud(std::move(readers));
  }
  NeighborRun run(const Neighborhood& neighborhood, const EngineOptions& options) const {
    InputCloud input = cloud();
    return neighbor_run(input, points, neighborhood, kMost, options);
  }
  /// Returns the first kMost of the k nearest within `radius`, without the neighbours beyond a point's own limits.
  Lists lists(std::size_t k, double radius, bool by_size, bool by_range) const {
    Lists out;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      const double own_k = by_size ? size[i] : kInf, own_radius = by_range ? range[i] : kInf;
      const double most = std::min({std::floor(own_k), double(k), double(kMost)});
      out.push_back(own_radius >= 0 && own_k >= 1
                        ? brute_force_neighbors_of(points, i, std::size_t(most), std::min(radius, own_radius))
                        : std::vector<std::uint32_t>{});
    }
    return out;
  }
};

Neighborhood limited(std::size_t k, double radius, const AttributeLimits& limits) {
  return {.k = k, .radius = radius, .rule = operators::limits_from_attributes(limits)};
}

/// Expects the exact lists from the reference engine, counted as exact, in both orders, with equal records.
void expect_counted(const Attributed& input, const Neighborhood& neighborhood, const Lists& exact) {
  std::vector<std::string> records;
  for (const Order order : kOrders) {
    const NeighborRun run = input.run(neighborhood, by(Engine::reference, order));
    EXPECT_EQ(run.statistics.reference->incomplete, differing(run.lists, exact));
    EXPECT_TRUE(records.empty() || run.records == records);
    records = run.records;
  }
}

TEST(ReferenceRules, LimitsFromAttributesAreThoseOfBruteForceWhereTheAuditSaysSo) {
  for (const auto& [name, shape] : trying_shapes()) {
    SCOPED_TRACE(name);
    const Attributed input(shape, 700);
    expect_counted(input, limited(kMost, kInf, {.k = "size"}), input.lists(kMost, kInf, true, false));
    expect_counted(input, limited(kMost, kInf, {.radius = "range"}), input.lists(kMost, kInf, false, true));
    expect_counted(input, limited(kMost, kInf, {.k = "size", .radius = "range"}), input.lists(kMost, kInf, true, true));
  }
}

TEST(ReferenceRules, ARadiusForEachPointIsExactWithinARadiusForAll) {
  for (const auto& [name, shape] : trying_shapes()) {
    const Attributed input(shape, 700);
    const double most = 0.05 * length(bounds_of(input.points).extent());
    const Lists exact = input.lists(kMost, most, false, true);
    for (const Order order : kOrders) {
      SCOPED_TRACE(name);
      const NeighborRun run =
          input.run(limited(Neighborhood::kUnlimited, most, {.radius = "range"}), by(Engine::reference, order));
      EXPECT_EQ(run.lists, exact);
      EXPECT_EQ(run.statistics.reference->incomplete, 0u);
    }
  }
}

TEST(ReferenceRules, LeastEigenentropyChoosesAsInTheExactEngineWhereTheAuditSaysSo) {
  const auto rule = operators::least_eigenentropy(6);
  for (const auto& [name, shape] : trying_shapes()) {
    SCOPED_TRACE(name);
    const Attributed input(shape, 700);
    const Neighborhood neighborhood{.k = kMost, .rule = rule};
    expect_counted(input, neighborhood, input.run(neighborhood, by(Engine::exact)).lists);
  }
}

TEST(ReferenceRules, ChainsGiveTheEnginesBytesWithinARadius) {
  const Attributed input(trying_shapes()[0].second, 3000);
  const auto chain = [](const SharedRule& rule) {
    return Chain{{.k = Neighborhood::kUnlimited, .radius = 0.12, .rule = rule},
                 {operators::neighborhood_size(), std::make_shared<Normals>()},
                 {}};
  };
  for (const SharedRule& rule :
       {operators::least_eigenentropy(6), operators::limits_from_attributes({.k = "size", .radius = "range"})}) {
    for (const Order order : kOrders) {
      InputCloud a = input.cloud(), b = input.cloud();
      const RunResult exact = run_in_memory(a, chain(rule), by(Engine::exact, order));
      const RunResult reference = run_in_memory(b, chain(rule), by(Engine::reference, order));
      EXPECT_TRUE(exact.records == reference.records);
      EXPECT_EQ(reference.statistics.reference->complete, input.points.size());
    }
  }
}

}  // namespace
}  // namespace pointsweep
