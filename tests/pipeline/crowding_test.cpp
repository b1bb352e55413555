// SPDX-License-Identifier: MIT
/// The operators features, sor, ror, lof, density and statistics give equal bytes for all threads, slabs and memory,
/// and for any order of the points.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <numeric>
#include <random>

#include "pointsweep/pipeline/language/build_chain.h"
#include "tests/pipeline/in_memory.h"
#include "tests/pipeline/moving_clouds.h"
#include "tests/support/sized.h"

namespace pointsweep {
namespace {

const char* const kCrowdedPipelines[] = {
    "knn(k=7) | features | density",
    "knn(k=6) | lof | sor(definition=open3d) | where(outlier == 0) | features(with_point=no, eigenvalues=sqrt)",
    "knn(k=5) | normals | splats | ror(radius=0.1, min_neighbors=5) | sor(definition=cloudcompare) | lof",
    "knn(radius=0.06) | density(radius=0.06) | ror(radius=0.03) | features(names=[height_range,eigenentropy])",
    "knn(k=20, adaptive=eigenentropy, k_min=4) | features | lof | density",
    "knn(k=9) | normals | statistics(nz_deviation, z_median, count, x_mean, where=\"nz > 0.3\") | "
    "statistics(count_majority)",
    "where(x < 0.5) | lof | reneighbor(k=3) | ror(radius=0.2, min_neighbors=3) | density",
};

RunResult result_of(const std::vector<Vec3>& points, const std::string& pipeline, EngineOptions options, Order order) {
  options.order = order;
  return run_in_memory(points, build_chain(parse_pipeline(pipeline), Facts{}), options);
}

TEST(FeaturesAndOutliers, AreTheSameBytesInMemoryAndSpilledByAnyThreadsAndSlabs) {
  for (const auto& [name, shape] : hostile_shapes()) {
    const std::vector<Vec3> points = make_cloud(shape, sized(700), 31);
    for (const char* pipeline : kCrowdedPipelines)
      for (const Order order : {Order::input, Order::sweep}) {
        SCOPED_TRACE(name + ", " + pipeline);
        const RunResult expected = result_of(points, pipeline, tiny(50'000, false, 1), order);
        for (const EngineOptions& options : {tiny(60, false, 2), tiny(150, true, 3)}) {
          const RunResult got = result_of(points, pipeline, options, order);
          ASSERT_EQ(got.schema, expected.schema);
          ASSERT_TRUE(got.records == expected.records);
          ASSERT_EQ(got.statistics.degenerate, expected.statistics.degenerate);
        }
      }
  }
}

/// Returns all records, sorted by their bytes.
std::vector<std::string> sorted_records(const RunResult& result) {
  std::vector<std::string> records;
  for (std::size_t at = 0; at < result.records.size(); at += result.schema.stride)
    records.emplace_back(reinterpret_cast<const char*>(result.records.data()) + at, result.schema.stride);
  std::ranges::sort(records);
  return records;
}

TEST(FeaturesAndOutliers, DoNotDependOnTheOrderOfThePoints) {
  for (const auto& [name, shape] : hostile_shapes()) {
    std::vector<Vec3> points = make_cloud(shape, sized(600), 32);
    for (const char* pipeline : kCrowdedPipelines) {
      SCOPED_TRACE(name + ", " + pipeline);
      const auto expected = sorted_records(result_of(points, pipeline, tiny(90), Order::input));
      std::shuffle(points.begin(), points.end(), std::mt19937_64(33));
      ASSERT_TRUE(sorted_records(result_of(points, pipeline, tiny(90), Order::input)) == expected);
    }
  }
}

}  // namespace
}  // namespace pointsweep
