// SPDX-License-Identifier: MIT
// Lesson 3: an operator of your own. Roughness is the distance of a point to the plane of its neighbours. The plane
// contains their centre and is perpendicular to the normal that the stage `normals` has computed. The output has the
// result as attribute "roughness".
//
//   03_own_operator scan.ply out.ply
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>

#include "pointsweep/pointsweep.h"

using namespace pointsweep;

class Roughness final : public LocalOperator {
 public:
  std::string name() const override { return "roughness"; }

  // Declares the attributes that the operator reads and makes. The engine derives from them how long points are
  // buffered before the operator runs.
  Contract contract() const override {
    return {.reads = {normal_attribute()},
            .makes = {scalar("roughness", Type::f32, "length", "distance to the plane of the neighbours")}};
  }

  // Computes one batch of points with their exact neighbourhoods. Many threads call apply() at once, so it keeps no
  // state.
  void apply(const Neighborhoods& in, Columns& out) const override {
    const auto roughness = out.column<float>(0);
    for (std::size_t i = 0; i < in.size(); ++i) {
      const auto n = in.value<std::array<float, 3>>(0, i);
      Vec3 center;  // centre of the neighbours, relative to the point
      for (std::size_t j = 0; j < in.count(i); ++j) center = center + in.offset(i, j);
      if (in.count(i) == 0 || (n[0] == 0 && n[1] == 0 && n[2] == 0)) {
        roughness[i] = 0;
        out.mark_degenerate(i);
      } else {
        center = (1.0 / static_cast<double>(in.count(i))) * center;
        roughness[i] = static_cast<float>(std::abs(dot(center, Vec3{n[0], n[1], n[2]})));
      }
    }
  }
};

int main(int argc, char** argv) try {
  if (argc != 3) return std::fprintf(stderr, "usage: %s IN OUT\n", argv[0]), 2;
  Cloud cloud({argv[1]});
  const Chain chain{.neighborhood = {.k = 16}, .stages = {operators::normals(), std::make_shared<Roughness>()}};
  RunOptions options;
  options.overwrite = true;
  const Statistics statistics = run(cloud, chain, {.points = argv[2]}, options);
  for (const auto& [name, seconds] : statistics.operator_seconds) std::printf("%-10s %.3f s\n", name.c_str(), seconds);
  return 0;
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
