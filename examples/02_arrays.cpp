// SPDX-License-Identifier: MIT
// Lesson 2: the same on arrays in memory, without files. Checks itself on a sphere, whose normals everybody knows.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <span>
#include <vector>

#include "pointsweep/pointsweep.h"

int main() try {
  using namespace pointsweep;
  constexpr std::size_t n = 50'000;
  std::vector<float> xyz;
  for (std::size_t i = 0; i < n; ++i) {  // a spiral from pole to pole, evenly spaced
    const double z = 1 - (2.0 * static_cast<double>(i) + 1) / n, r = std::sqrt(1 - z * z);
    const double turn = 2.399963229728653 * static_cast<double>(i);
    for (const double c : {r * std::cos(turn), r * std::sin(turn), z}) xyz.push_back(static_cast<float>(c));
  }

  Cloud cloud(std::make_unique<ArrayReader>(std::span<const float>(xyz)));
  std::vector<float> normals(3 * n);
  Outputs outputs;
  outputs.writer = [&](const OutputPlan& plan) {
    return std::make_unique<ArrayWriter<float>>(plan, std::vector<std::string>{"nx", "ny", "nz"}, std::span(normals));
  };
  const Chain chain{.neighborhood = {.k = 12}, .stages = {operators::normals()}};
  run(cloud, chain, outputs);

  double worst = 1;
  for (std::size_t i = 0; i < 3 * n; i += 3) {
    const double cosine =
        double{xyz[i]} * normals[i] + double{xyz[i + 1]} * normals[i + 1] + double{xyz[i + 2]} * normals[i + 2];
    worst = std::min(worst, std::abs(cosine));
  }
  std::printf("%zu normals of a sphere, the worst %.4f rad from the radius\n", n, std::acos(worst));
  return std::acos(worst) < 0.02 ? 0 : 1;
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
