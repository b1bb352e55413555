// SPDX-License-Identifier: MIT
// Errors of curvatures on dense noiseless surfaces, with normals estimated from equal neighbourhoods.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "pointsweep/pipeline/language/build_chain.h"
#include "tests/operators/analytic_surface.h"
#include "tests/pipeline/in_memory.h"

namespace pointsweep {
namespace {

constexpr std::size_t kPoints = 500'000;

/// Mean errors and mean absolute errors, relative to the true k1. Errors of k2 are relative to k1 as well, since k2 may
/// be 0.
struct Errors {
  double k1 = 0, k2 = 0, mean = 0, k1_size = 0, k2_size = 0;
};

template <class Draw, class Keep>
Errors errors_of(std::size_t k, Draw draw, Keep keep) {
  AnalyticSurface surface(21);
  const std::vector<AnalyticPoint> truth = AnalyticSurface::draw(kPoints, [&] { return draw(surface); });
  Chain chain = build_chain(parse_pipeline(fmt::format("knn(k={}) | normals | curvature", k)), Facts{});
  chain.keep = {"k1", "k2"};
  const RunResult found = run_in_memory(positions_of(truth), chain, {});
  const std::vector<double> k1 = found.field("k1"), k2 = found.field("k2");
  Errors e;
  double n = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (!keep(truth[i])) continue;
    const double e1 = k1[i] / truth[i].k1 - 1, e2 = (k2[i] - truth[i].k2) / truth[i].k1;
    e.k1 += e1, e.k2 += e2, e.k1_size += std::abs(e1), e.k2_size += std::abs(e2);
    e.mean += (k1[i] + k2[i]) / (truth[i].k1 + truth[i].k2) - 1;
    ++n;
  }
  for (double* sum : {&e.k1, &e.k2, &e.mean, &e.k1_size, &e.k2_size}) *sum /= n;
  std::printf("k = %2zu: k1 %+.1f %% (%.1f %%), k2 %+.1f %% (%.1f %%), mean curvature %+.1f %%\n", k, 100 * e.k1,
              100 * e.k1_size, 100 * e.k2, 100 * e.k2_size, 100 * e.mean);
  return e;
}

/// Largest mean errors allowed at one k.
struct Bounds {
  std::size_t k;
  double k1, k2, mean;
};

template <class Draw, class Keep>
void expect_bounds(std::initializer_list<Bounds> all, Draw draw, Keep keep) {
  for (const Bounds& b : all) {
    SCOPED_TRACE(b.k);
    const Errors e = errors_of(b.k, draw, keep);
    EXPECT_LE(std::abs(e.k1), b.k1);
    EXPECT_LE(std::abs(e.k2), b.k2);
    EXPECT_LE(std::abs(e.mean), b.mean);
  }
}

const auto kAll = [](const AnalyticPoint&) { return true; };

TEST(CurvatureBias, OfASphereFallsAsKGrows) {
  expect_bounds(
      {{8, 0.06, 0.3, 0.13}, {16, 0.04, 0.19, 0.08}, {32, 0.035, 0.1, 0.04}, {64, 0.03, 0.04, 0.01}},
      [](AnalyticSurface& s) { return s.sphere(1); }, kAll);
}

TEST(CurvatureBias, OfACylinderFallsAsKGrows) {
  expect_bounds(
      {{8, 0.07, 0.18, 0.12}, {16, 0.05, 0.11, 0.06}, {32, 0.03, 0.07, 0.05}, {64, 0.01, 0.05, 0.045}},
      [](AnalyticSurface& s) { return s.cylinder(0.5, 4); },
      [](const AnalyticPoint& p) { return p.position.z > 0.2 && p.position.z < 3.8; });
}

TEST(CurvatureBias, OfATorusFallsAsKGrows) {
  expect_bounds(
      {{8, 0.06, 0.03, 0.04}, {16, 0.05, 0.02, 0.04}, {32, 0.03, 0.02, 0.03}, {64, 0.02, 0.02, 0.02}},
      [](AnalyticSurface& s) { return s.torus(0.4); }, kAll);
}

}  // namespace
}  // namespace pointsweep
