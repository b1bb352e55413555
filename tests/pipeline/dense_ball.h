// SPDX-License-Identifier: MIT
/// The survey of a ball that has three quarters of its points within a tenth of its radius. Cells of the sparse rim
/// wait for far points, and dense cells wait for the rim.
#pragma once

#include <cmath>
#include <random>

#include "pointsweep/order/survey.h"

namespace pointsweep {

inline Survey survey_of_dense_ball() {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> share(0, 1);
  Survey survey;
  for (std::size_t i = 0; i < 65'536; ++i) {
    const Vec3 p{normal(random), normal(random), normal(random)};
    const double radius = (i % 4 == 0 ? 10 : 1) * std::cbrt(share(random)) / length(p);
    survey.sample.push_back({radius * p.x, radius * p.y, radius * p.z / 2});
    survey.bounds.include(survey.sample.back());
  }
  survey.dimension = box_counting_dimension(survey.sample);
  return survey;
}

}  // namespace pointsweep
