// SPDX-License-Identifier: MIT
// Lesson 2: normals and curvatures of arrays in memory, without files. The program checks itself on a sphere, whose
// normals and curvatures are known.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "pointsweep/pointsweep.h"

int main() try {
  using namespace pointsweep;
  constexpr std::size_t n = 50'000;
  std::vector<std::array<float, 3>> xyz;
  for (std::size_t i = 0; i < n; ++i) {  // a spiral from pole to pole, evenly spaced
    const double z = 1 - (2.0 * static_cast<double>(i) + 1) / n, r = std::sqrt(1 - z * z);
    const double turn = 2.399963229728653 * static_cast<double>(i);
    xyz.push_back(
        {static_cast<float>(r * std::cos(turn)), static_cast<float>(r * std::sin(turn)), static_cast<float>(z)});
  }

  const std::vector<std::array<float, 3>> unit = normals(xyz);
  const ArrayResults results = run(xyz, {.stages = {operators::normals(), operators::curvature()}});
  const std::vector<float> k1 = results.get<float>("k1");

  double worst = 1;
  for (std::size_t i = 0; i < n; ++i) {
    const double cosine =
        double{xyz[i][0]} * unit[i][0] + double{xyz[i][1]} * unit[i][1] + double{xyz[i][2]} * unit[i][2];
    worst = std::min(worst, std::abs(cosine));
  }
  double mean = 0;
  for (const float k : k1) mean += static_cast<double>(k) / n;
  std::printf("%zu normals of a sphere, the worst %.4f rad from the radius; mean k1 %.3f\n", n, std::acos(worst), mean);
  return std::acos(worst) < 0.02 && std::abs(mean - 1) < 0.05 ? 0 : 1;
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
