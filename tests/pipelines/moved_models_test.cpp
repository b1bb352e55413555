// SPDX-License-Identifier: MIT
// Normals, splats and sizes of neighbourhoods of scanned models after fairing and other moves, at k = 64, against
// Equation 1 written out in long double over the neighbours found before the move.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "pointsweep/operators/statistics/neighbor_rows.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "tests/operators/analytic_surface.h"
#include "tests/operators/equation1.h"
#include "tests/pipeline/in_memory.h"
#include "tests/support/data_folder.h"

namespace pointsweep {
namespace {

constexpr std::size_t kNeighbors = 64;

/// An operator that rounds positions to a grid so coarse that many points coincide.
class Snap final : public LocalOperator {
 public:
  explicit Snap(double side) : side_(side) {}
  std::string name() const override { return "snap"; }
  Contract contract() const override { return {{}, {}, {position_attribute()}}; }
  void apply(const Neighborhoods& in, Columns& out) const override {
    for (std::size_t i = 0; i < in.size(); ++i) {
      const Vec3 p = in.position(i);
      out.column<std::array<double, 3>>(0)[i] = {snapped(p.x), snapped(p.y), snapped(p.z)};
    }
  }

 private:
  double snapped(double v) const { return side_ * std::round(v / side_); }
  double side_;
};

/// Returns the vertices of an ascii PLY file whose vertex lines begin with x y z.
std::vector<Vec3> vertices_of(const std::filesystem::path& path) {
  std::ifstream in(path);
  std::size_t count = 0;
  std::string line, word, kind;
  while (std::getline(in, line) && !line.starts_with("end_header")) {
    std::istringstream words(line);
    if (words >> word >> kind && word == "element" && kind == "vertex") words >> count;
  }
  std::vector<Vec3> vertices;
  for (std::size_t i = 0; i < count && std::getline(in, line); ++i) {
    Vec3 p;
    std::istringstream(line) >> p.x >> p.y >> p.z;
    vertices.push_back(p);
  }
  return vertices;
}

using Lists = std::vector<std::vector<std::uint32_t>>;

Lists neighbors_of(const std::vector<Vec3>& points) {
  const Chain graph{{.k = kNeighbors}, {std::make_shared<NeighborRows>(kNeighbors, points.size(), false)}};
  const RunResult found = run_in_memory(points, graph, {});
  Lists lists(points.size());
  for (std::size_t j = 0; j < kNeighbors; ++j) {
    const std::vector<double> rows = found.field(fmt::format("neighbor_{}", j));
    for (std::size_t i = 0; i < points.size(); ++i) lists[i].push_back(static_cast<std::uint32_t>(rows[i]));
  }
  return lists;
}

/// The normal by Equation 1 at the moved positions, over the neighbours found before the move.
struct Plane {
  Vec3 normal;
  double tolerance, farthest;
  bool defined;

  Plane(const std::vector<Vec3>& points, std::size_t i, const std::vector<std::uint32_t>& neighbors) {
    const Equation1 equation(points, i, neighbors);
    normal = equation.normal;
    tolerance = 2e-7 + 1e-7 / equation.own_gap;
    double farthest2 = 0;
    for (const std::uint32_t j : neighbors) farthest2 = std::max(farthest2, distance2(points[i], points[j]));
    farthest = std::sqrt(farthest2);
    defined = equation.gap > 1e-8;
  }
};

void expect_equation1(const RunResult& result, const Lists& lists) {
  const std::vector<double> x = result.field("x"), y = result.field("y"), z = result.field("z"),
                            nx = result.field("nx"), ny = result.field("ny"), nz = result.field("nz"),
                            radius = result.field("neighbor_radius");
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < x.size(); ++i) points.push_back({x[i], y[i], z[i]});
  std::size_t compared = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Plane truth(points, i, lists[i]);
    ASSERT_NEAR(radius[i], truth.farthest, 1e-12 * truth.farthest) << i;
    if (!truth.defined) continue;
    ++compared;
    const Vec3 n{nx[i], ny[i], nz[i]};
    ASSERT_NEAR(length(n), 1, 1e-6) << i;
    ASSERT_LE(line_angle(n, truth.normal), truth.tolerance) << i;
  }
  EXPECT_GT(compared, points.size() * 9 / 10);
}

TEST(MovedModels, NormalsAreThoseOfEquation1InEveryWayToRun) {
  const std::filesystem::path data = data_folder();
  if (data.empty()) GTEST_SKIP() << "POINTSWEEP_DATA names no folder of real scans";
  const std::vector<Vec3> points = vertices_of(data / "models/stanford_dragon/dragon_vrip_res3.ply");
  ASSERT_GT(points.size(), 20'000u);
  const Lists lists = neighbors_of(points);
  for (const char* end : {"fair", "fair | normals | splats | fair(f=2, g=2)"}) {
    SCOPED_TRACE(end);
    const std::string text =
        fmt::format("knn(k={}) | normals | splats | {} | normals | neighborhood_size", kNeighbors, end);
    const Chain chain = build_chain(parse_pipeline(text), Facts{});
    const RunResult plain = run_in_memory(points, chain, {});
    expect_equation1(plain, lists);
    for (const std::uint64_t slab : {400u, 3000u}) {
      EngineOptions options;
      options.slab_points = slab, options.cell_points = 256, options.spill = true, options.resources.threads = 3;
      const RunResult recalled = run_in_memory(points, chain, options);
      EXPECT_EQ(recalled.records, plain.records) << slab;
    }
  }
}

TEST(MovedModels, SnappedToAGridHaveNormalsWhereverTheyHavePlanes) {
  const std::filesystem::path data = data_folder();
  if (data.empty()) GTEST_SKIP() << "POINTSWEEP_DATA names no folder of real scans";
  const std::vector<Vec3> points = vertices_of(data / "models/stanford_dragon/dragon_vrip_res3.ply");
  Chain chain =
      build_chain(parse_pipeline(fmt::format("knn(k={}) | normals | neighborhood_size", kNeighbors)), Facts{});
  chain.stages.insert(chain.stages.begin(), std::make_shared<Snap>(0.004));
  expect_equation1(run_in_memory(points, chain, {}), neighbors_of(points));
}

}  // namespace
}  // namespace pointsweep
