// SPDX-License-Identifier: MIT
// Splats cover surfaces without holes: generated ones, and the triangles of scanned models.
#include "tests/pipelines/splat_cover.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <sstream>

#include "tests/operators/analytic_surface.h"
#include "tests/support/data_folder.h"

namespace pointsweep {
namespace {

/// A model of vertices and triangles in an ascii PLY file whose vertices begin with x y z.
struct Model {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::size_t, 3>> triangles;

  explicit Model(const std::filesystem::path& path) {
    std::ifstream in(path);
    std::size_t vertex_count = 0, face_count = 0;
    std::string line, word, kind;
    while (std::getline(in, line) && !line.starts_with("end_header")) {
      std::istringstream words(line);
      if (words >> word >> kind && word == "element") words >> (kind == "vertex" ? vertex_count : face_count);
    }
    for (std::size_t i = 0; i < vertex_count && std::getline(in, line); ++i) {
      Vec3 p;
      std::istringstream(line) >> p.x >> p.y >> p.z;
      vertices.push_back(p);
    }
    for (std::size_t i = 0; i < face_count && std::getline(in, line); ++i) {
      std::size_t corners = 0;
      std::array<std::size_t, 3> t{};
      std::istringstream(line) >> corners >> t[0] >> t[1] >> t[2];
      triangles.push_back(t);
    }
  }

  /// Returns random points of the triangles, uniform by area.
  std::vector<Vec3> draw(std::size_t n) const {
    std::vector<double> area;
    for (const auto& t : triangles)
      area.push_back(length(cross(vertices[t[1]] - vertices[t[0]], vertices[t[2]] - vertices[t[0]])));
    std::mt19937_64 random(5);
    std::discrete_distribution<std::size_t> triangle(area.begin(), area.end());
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < n; ++i) {
      const auto& t = triangles[triangle(random)];
      const double root = std::sqrt(uniform(random)), v = uniform(random);
      points.push_back((1 - root) * vertices[t[0]] + (root * (1 - v)) * vertices[t[1]] + (root * v) * vertices[t[2]]);
    }
    return points;
  }
};

constexpr std::size_t kAsked = 100'000;

const std::vector<std::string>& pipelines() {
  static const std::vector<std::string> all{"knn(k=8) | normals | splats", "knn(k=16) | normals | splats",
                                            "knn(k=16) | normals | curvature | splats"};
  return all;
}

void expect_covered(const std::string& name, const std::vector<Vec3>& points, const std::vector<Vec3>& surface,
                    double most_bare, double most_deep) {
  for (const std::string& pipeline : pipelines()) {
    const Covered c = covered(SplatCover(points, pipeline), surface);
    const std::string measured =
        fmt::format("{}, {}: {:.4f} % bare, {:.1f} deep", name, pipeline, 100 * c.bare, c.depth);
    testing::Test::RecordProperty(name + pipeline, measured);
    std::printf("%s\n", measured.c_str());
    EXPECT_LE(c.bare, most_bare) << measured;
    EXPECT_LE(c.depth, most_deep) << measured;
  }
}

TEST(SplatCover, OfASphereAndATorusHasNoHoles) {
  AnalyticSurface points(11), asked(12);
  const auto positions = [](AnalyticSurface& s, std::size_t n, auto draw) {
    return positions_of(AnalyticSurface::draw(n, [&] { return draw(s); }));
  };
  const auto sphere = [](AnalyticSurface& s) { return s.sphere(2); };
  const auto torus = [](AnalyticSurface& s) { return s.torus(0.4); };
  expect_covered("sphere", positions(points, 50'000, sphere), positions(asked, kAsked, sphere), 0.001, 9);
  expect_covered("torus", positions(points, 50'000, torus), positions(asked, kAsked, torus), 0.001, 9);
}

TEST(SplatCover, OfScannedModelsHasNoHoles) {
  const std::filesystem::path data = data_folder();
  if (data.empty()) GTEST_SKIP() << "POINTSWEEP_DATA names no folder of real scans";
  for (const char* file :
       {"models/stanford_bunny/reconstruction/bun_zipper.ply", "models/stanford_dragon/dragon_vrip_res3.ply"}) {
    ASSERT_TRUE(std::filesystem::exists(data / file)) << file;
    const Model model(data / file);
    ASSERT_GT(model.triangles.size(), 45'000u);
    expect_covered(std::filesystem::path(file).stem(), model.vertices, model.draw(kAsked), 0.001, 9);
  }
}

}  // namespace
}  // namespace pointsweep
