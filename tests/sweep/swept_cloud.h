// SPDX-License-Identifier: MIT
/// Clouds that are hard to sweep, and sweeps over points in memory without the other phases of a run.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <mutex>
#include <random>

#include "pointsweep/operators/surface/curvature.h"
#include "pointsweep/operators/surface/fair.h"
#include "pointsweep/operators/surface/normals.h"
#include "pointsweep/operators/surface/splats.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/sweep/sweep.h"
#include "pointsweep/threads.h"
#include "tests/support/memory_source.h"

namespace pointsweep {

/// A sink of result records by row. Each row must come exactly once.
class Collected final : public Sink {
 public:
  Collected(std::size_t points, std::uint32_t bytes) : bytes_(bytes), records(points * bytes), times(points) {}
  void finished(const Finished& points) override {
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 0; i < points.size; ++i) {
      std::memcpy(&records[points.rows[i] * bytes_], points.results + i * bytes_, bytes_);
      ++times[points.rows[i]];
    }
  }

 private:
  std::mutex mutex_;
  std::uint32_t bytes_;

 public:
  std::vector<std::byte> records;
  std::vector<int> times;
};

struct Swept {
  std::vector<std::byte> records;
  SweepStatistics statistics;
};

/// Returns a chain of four steps: a step begins with a stage that reads attributes of neighbours made by earlier
/// stages.
inline Chain deep_chain(std::size_t k) {
  return {.neighborhood = {.k = k},
          .stages = {std::make_shared<Normals>(), std::make_shared<Curvature>(), std::make_shared<Splats>(),
                     std::make_shared<Fair>(FairOptions{.f = 0.05, .g = 0.05}), std::make_shared<Normals>(),
                     std::make_shared<Splats>()}};
}

inline Swept swept(const std::vector<Vec3>& points, const Chain& chain, std::uint64_t slab_points,
                   const SweepOptions& options) {
  const PointSource source = source_of(points);
  PlannedPass planned = plan_chain(chain, source.schema).passes.front();
  StreamOptions order;
  order.slab_points = slab_points;
  order.canonical = false;
  const Stream stream(source, survey(source, std::nullopt, true), order);
  planned.bind(stream.record_schema());
  Collected sink(points.size(), planned.plan.result_bytes);
  Swept out;
  with_threads(3, [&] { out.statistics = sweep(stream, planned.plan, sink, options); });
  EXPECT_EQ(std::ranges::count(sink.times, 1), std::ptrdiff_t(points.size())) << "each point is finished once";
  out.records = std::move(sink.records);
  return out;
}

inline double uniform(std::mt19937_64& rng) { return std::uniform_real_distribution<double>(0, 1)(rng); }

/// Returns points of a bent surface. odd(generator, p, i) returns point i, which is p or another place.
template <class Odd>
std::vector<Vec3> surface(std::size_t points, Odd odd) {
  std::mt19937_64 rng(17);
  std::vector<Vec3> cloud;
  for (std::size_t i = 0; i < points; ++i) {
    const double u = 4 * uniform(rng), v = uniform(rng);
    cloud.push_back(odd(rng, Vec3{u, v, 0.1 * std::sin(7 * u) * std::cos(5 * v)}, i));
  }
  return cloud;
}

inline std::vector<std::pair<std::string, std::vector<Vec3>>> clouds() {
  const std::size_t n = 1200;
  return {
      {"outliers", surface(n,
                           [](auto& rng, Vec3 p, std::size_t i) {
                             return i % 29 == 0 ? Vec3{4 * uniform(rng), uniform(rng), 10 * uniform(rng) - 5} : p;
                           })},
      {"density that falls by a factor of a thousand, with points far away",
       surface(n,
               [](auto& rng, Vec3 p, std::size_t i) {
                 return Vec3{std::pow(p.x / 4, 12) * 40, p.y, i % 53 == 0 ? 50 * uniform(rng) : p.z};
               })},
      {"copies of a few points, and points around them",
       surface(n,
               [](auto& rng, Vec3 p, std::size_t i) {
                 if (i % 3 == 0) return Vec3{std::floor(p.x), 0.5, 0.3};
                 return i % 31 == 0 ? Vec3{4 * uniform(rng), uniform(rng), 0.4} : p;
               })},
      {"a grid, full of ties, with points far away",
       surface(n,
               [](auto& rng, Vec3 p, std::size_t i) {
                 if (i % 53 == 0) return Vec3{40 * uniform(rng), 10 * uniform(rng), 5 * uniform(rng)};
                 return Vec3{std::round(40 * p.x) / 40, std::round(40 * p.y) / 40, 0};
               })},
  };
}

inline void expect_same(const Swept& some, const Swept& whole) {
  EXPECT_TRUE(some.records == whole.records);
  EXPECT_EQ(some.statistics.certified, whole.statistics.certified);
  for (std::size_t s = 0; s < whole.statistics.degenerate.size(); ++s) {
    EXPECT_EQ(some.statistics.degenerate[s].count(), whole.statistics.degenerate[s].count()) << s;
    EXPECT_EQ(some.statistics.degenerate[s].lowest(), whole.statistics.degenerate[s].lowest()) << s;
  }
}

}  // namespace pointsweep
