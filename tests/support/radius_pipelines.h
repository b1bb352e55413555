// SPDX-License-Identifier: MIT
/// Pairs of points at exactly the radius that includes both, and pipelines that search within that radius.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/program/pipeline.h"

namespace pointsweep {

/// Two points p and q, and the least radius R with ((dx² + dy²) + dz²) <= R·R in double.
struct PairAtRadius {
  Vec3 p, q;
  double radius = 0;

  PairAtRadius(Vec3 first, Vec3 second) : p(first), q(second) {
    const double dx = p.x - q.x, dy = p.y - q.y, dz = p.z - q.z, d2 = (dx * dx + dy * dy) + dz * dz;
    radius = std::sqrt(d2);
    while (radius * radius < d2) radius = above(radius);
    while (below(radius) * below(radius) >= d2) radius = below(radius);
  }
  static double above(double r) { return std::nextafter(r, HUGE_VAL); }
  static double below(double r) { return std::nextafter(r, 0); }
};

/// Returns pairs of equal height, so that the distance to a vertical axis equals the distance of the pair. Some
/// distances are small relative to the coordinates; for some, the rounded square root is smaller than the radius.
inline std::vector<PairAtRadius> pairs_at_radius() {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<PairAtRadius> all = {
      {{0, 0, 0}, {3, 4, 0}}, {{-1e-20, 0, 0}, {1, 0, 0}}, {{5e5 + 0.1, 5.4e6 + 0.7, 2}, {5e5 + 0.4, 5.4e6 + 1.1, 2}}};
  for (int i = 0; i < 5; ++i) {
    const Vec3 p{100 * uniform(random), 100 * uniform(random), uniform(random)};
    all.push_back({p, {p.x + uniform(random), p.y + uniform(random), p.z}});
  }
  return all;
}

/// Returns for each operator and option a pipeline that searches points within the radius {r}, which is also the
/// attribute `own`.
inline const std::map<std::string, std::string>& radius_pipelines() {
  static const std::map<std::string, std::string> pipelines = {
      {"knn radius", "knn(radius={r}) | neighborhood_size"},
      {"knn radius_from", "knn(k=1, radius_from=own) | neighborhood_size"},
      {"reneighbor radius", "knn(k=1) | normals | reneighbor(radius={r}) | neighborhood_size"},
      {"reneighbor radius_from", "knn(k=1) | normals | reneighbor(k=1, radius_from=own) | neighborhood_size"},
      {"ror radius", "knn(k=1) | ror(radius={r}, min_neighbors=1)"},
      {"density radius", "knn(radius={wide}) | density(radius={r})"},
      {"components distance", "knn(radius={wide}) | components(distance={r})"},
      {"segments distance", "knn(radius={wide}) | segments(distance={r})"},
      {"dbscan eps", "knn(radius={wide}) | dbscan(eps={r}, min_points=2)"},
      {"poisson radius", "poisson({r})"},
      {"poisson radius_from", "poisson(100, radius_from=own)"},
      {"simplify most", "simplify(1e10, most={r})"},
      {"simplify least", "simplify(1e-300, most=100, least={r})"},
      {"distance_to most", "distance_to({other}, most={r})"},
      {"take most", "take({other}, attributes=label, most={r}, missing=0)"},
      {"m3c2 cylinder", "m3c2({other}, cylinder={wide}, depth=1)"}};
  return pipelines;
}

/// Returns the pipeline `text` of radius_pipelines() with values. `other`: file of another cloud.
inline std::string radius_pipeline(const std::string& text, double radius, const std::string& other) {
  return fmt::format(fmt::runtime(text), fmt::arg("r", radius), fmt::arg("wide", 2 * radius), fmt::arg("other", other));
}

/// Returns names such as "ror radius" of all options of the registry that mean a radius.
inline std::set<std::string> radii_of_registry() {
  std::set<std::string> radii;
  const auto add = [&](const std::string& name, const std::vector<OptionDeclaration>& options) {
    for (const OptionDeclaration& option : options)
      if (option.is_radius) radii.insert(name + " " + option.name);
  };
  add(neighborhood_declaration().name, neighborhood_declaration().options);
  for (const OperatorDeclaration& declaration : all_operators()) add(declaration.name, declaration.options);
  return radii;
}

}  // namespace pointsweep
