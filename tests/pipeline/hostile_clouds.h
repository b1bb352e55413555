// SPDX-License-Identifier: MIT
/// Clouds that are hard for an engine, each a function of a random generator.
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/geometry.h"

namespace pointsweep {

using CloudShape = std::function<Vec3(std::mt19937_64&)>;

inline double uniform(std::mt19937_64& rng) { return std::uniform_real_distribution<double>(0, 1)(rng); }

inline std::vector<std::pair<std::string, CloudShape>> hostile_shapes() {
  return {
      {"closed surface",
       [](auto& r) {
         std::normal_distribution<double> g;
         Vec3 p{g(r), g(r), 2 * g(r)};
         return (1 / length(p)) * p;
       }},
      {"volume",
       [](auto& r) {
         return Vec3{uniform(r), uniform(r), uniform(r)};
       }},
      {"all equal along two axes",
       [](auto& r) {
         return Vec3{3, uniform(r), 7};
       }},
      {"plane across the longest axis",
       [](auto& r) {
         return Vec3{uniform(r), uniform(r), uniform(r) < 0.001 ? 1e3 : 0};
       }},
      {"grid full of ties",
       [](auto& r) {
         return Vec3{std::floor(12 * uniform(r)), std::floor(12 * uniform(r)), std::floor(12 * uniform(r))};
       }},
      {"every point many times",
       [](auto& r) {
         return Vec3{std::floor(30 * uniform(r)), 0, 0};
       }},
      {"most at one place of a surface",
       [](auto& r) {
         return uniform(r) < 0.7 ? Vec3{0.3, 0.3, 0.02} : Vec3{uniform(r), uniform(r), 0.1 * uniform(r) * uniform(r)};
       }},
      {"noisy wall across the longest axis",
       [](auto& r) {
         return uniform(r) < 0.8 ? Vec3{4 + 1e-4 * uniform(r), uniform(r), uniform(r)}
                                 : Vec3{10 * uniform(r), uniform(r), 0.001 * uniform(r)};
       }},
      {"one place",
       [](auto&) {
         return Vec3{1, 2, 3};
       }},
      {"outliers in a box a thousand times larger",
       [](auto& r) {
         const double s = uniform(r) < 0.01 ? 1e3 : 1;
         return Vec3{s * (uniform(r) - 0.5), s * (uniform(r) - 0.5), s * (uniform(r) - 0.5) * 0.01};
       }},
      {"density over four decades",
       [](auto& r) {
         const double d = std::pow(10, 4 * uniform(r) - 4), a = 2 * M_PI * uniform(r);
         return Vec3{d * std::cos(a), d * std::sin(a), 0.01 * d * uniform(r)};
       }},
      {"two stations",
       [](auto& r) {
         const double d = std::pow(10, 3 * uniform(r) - 3), a = 2 * M_PI * uniform(r), x = uniform(r) < 0.5 ? 0 : 0.7;
         return Vec3{x + d * std::cos(a), d * std::sin(a), 0.001 * d * uniform(r)};
       }},
      {"national grid in millimetres",
       [](auto& r) {
         return Vec3{5e6 + std::round(4e3 * uniform(r)) / 1e3, 4e6 + std::round(4e3 * uniform(r)) / 1e3, 100};
       }},
      {"some not finite",
       [](auto& r) {
         const double u = uniform(r);
         const double bad = u < 0.02   ? std::numeric_limits<double>::quiet_NaN()
                            : u < 0.04 ? std::numeric_limits<double>::infinity()
                                       : 0;
         return Vec3{uniform(r), uniform(r) + bad, uniform(r)};
       }},
      {"a few points far beside a long surface",
       [](auto& r) {
         const double x = 40 * uniform(r), y = uniform(r);
         return Vec3{x, y, uniform(r) < 0.03 ? 10 * uniform(r) - 5 : 0};
       }},
  };
}

inline std::vector<Vec3> make_cloud(const CloudShape& shape, std::size_t n, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::vector<Vec3> points(n);
  for (Vec3& p : points) p = shape(rng);
  return points;
}

}  // namespace pointsweep
