// SPDX-License-Identifier: MIT
/// A cloud with neighbourhoods of every kind, for the kernels of operators.
#pragma once

#include <cmath>
#include <cstdint>
#include <iterator>
#include <random>
#include <vector>

#include "pointsweep/geometry.h"
#include "tests/support/brute_force.h"

namespace pointsweep {

/// A volume, a plane, a line and duplicates, with neighbourhoods of 0 to 1000 points, in one batch.
struct MixedCloud {
  std::vector<Vec3> points;
  std::vector<std::vector<std::uint32_t>> lists;

  explicit MixedCloud(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> u(-1, 1);
    for (int i = 0; i < 1300; ++i) {
      const Vec3 p{u(random), u(random), u(random)};
      points.push_back(i % 5 == 0   ? Vec3{p.x, p.y, 0.25}
                       : i % 5 == 1 ? Vec3{p.x, 2 * p.x, 3 * p.x}
                       : i % 5 == 2 ? Vec3{std::round(3 * p.x), std::round(3 * p.y), 0}
                                    : 1e-7 * p + Vec3{1000, 2000, 3000});
    }
    const std::size_t counts[] = {8, 8, 0, 1, 2, 3, 8, 9, 7, 17, 64, 8, 1000, 16, 33};
    for (std::uint32_t i = 0; i < points.size(); ++i)
      lists.push_back(brute_force_neighbors_of(points, i, counts[i % std::size(counts)], 1e9));
  }
};

}  // namespace pointsweep
