// SPDX-License-Identifier: MIT
/// The examples of all operators, as pipelines that run on a cloud of a test.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <random>
#include <regex>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/program/pipeline.h"
#include "tests/formats/point_files.h"

namespace pointsweep {

struct Example {
  std::string name;  ///< name of the operator
  std::string pipeline;
};

inline std::vector<std::string> names_of_all_operators() {
  std::vector<std::string> names;
  for (const OperatorDeclaration& declaration : all_operators()) names.push_back(declaration.name);
  return names;
}

/// Returns the example in the declaration of the operator, with `other_cloud` in place of its file names.
inline Example example_of(const std::string& name, const std::string& other_cloud) {
  static const std::regex file("[a-z]+\\.las");
  return {name, std::regex_replace(declaration_of(name)->example, file, other_cloud)};
}

/// Returns hilly ground of 4 points per unit of area, and a wall across the x axis. Radii and cells of the examples
/// hold some points each, and a tenth of the points have nearly equal x.
inline std::vector<Vec3> cloud_for_examples(std::size_t n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  const double side = std::sqrt(static_cast<double>(n) / 4);
  std::vector<Vec3> points(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double u = side * uniform(random), v = side * uniform(random);
    points[i] = i % 10 == 0 ? Vec3{side / 2 + 0.01 * uniform(random), u, 0.2 * v}
                            : Vec3{u, v, 2 * std::sin(0.2 * u) * std::cos(0.3 * v) + 0.05 * uniform(random)};
  }
  return points;
}

/// Writes a file of float64 coordinates.
inline void write_points(const std::filesystem::path& path, const std::vector<Vec3>& points) {
  Schema schema;
  for (const char* field : {"x", "y", "z"}) schema.append(field, Type::f64);
  write_all(plan_for(path, points.size(), schema), std::as_bytes(std::span(points)));
}

/// Writes a file of float64 coordinates with a classification and a tree_id.
inline void write_labelled_points(const std::filesystem::path& path, const std::vector<Vec3>& points) {
  Schema schema;
  for (const char* field : {"x", "y", "z"}) schema.append(field, Type::f64);
  schema.append("classification", Type::u8);
  schema.append("tree_id", Type::u32);
  std::vector<std::byte> records(points.size() * schema.stride);
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::byte* const record = records.data() + i * schema.stride;
    for (std::size_t f = 0; f < 3; ++f) set_value(schema.fields[f], record, points[i][static_cast<int>(f)]);
    set_value(schema.fields[3], record, static_cast<double>(i % 5));
    set_value(schema.fields[4], record, static_cast<double>(100'000 + i));
  }
  write_all(plan_for(path, points.size(), schema), records);
}

}  // namespace pointsweep
