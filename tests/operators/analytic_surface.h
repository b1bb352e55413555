// SPDX-License-Identifier: MIT
/// Random points of surfaces whose normals and curvatures are known, and the columns that operator tests make from
/// them.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <numbers>
#include <random>
#include <span>
#include <vector>

#include "pointsweep/geometry.h"

namespace pointsweep {

struct AnalyticPoint {
  Vec3 position, normal;
  double k1 = 0, k2 = 0;  // without sign
  Vec3 k1_direction;      // 0 where k1 = k2
};

inline constexpr double kTurn = 2 * std::numbers::pi;

/// Draws points of even density by area.
class AnalyticSurface {
 public:
  explicit AnalyticSurface(unsigned seed) : random_(seed) {}

  AnalyticPoint sphere(double radius) {
    const double z = uniform(-1, 1), a = uniform(0, kTurn), s = std::sqrt(1 - z * z);
    const Vec3 n{s * std::cos(a), s * std::sin(a), z};
    return {radius * n, n, 1 / radius, 1 / radius, {}};
  }
  /// Returns a point of a cylinder around the z axis with 0 <= z < height.
  AnalyticPoint cylinder(double radius, double height) {
    const double a = uniform(0, kTurn);
    const Vec3 n{std::cos(a), std::sin(a), 0};
    return {radius * n + Vec3{0, 0, uniform(0, height)}, n, 1 / radius, 0, {-n.y, n.x, 0}};
  }
  /// Returns a point of a torus: a tube around a circle of radius 1 about the z axis.
  AnalyticPoint torus(double tube) {
    for (;;) {
      const double a = uniform(0, kTurn), b = uniform(0, kTurn), to_axis = 1 + tube * std::cos(b);
      if (uniform(0, 1 + tube) > to_axis) continue;
      const Vec3 out{std::cos(a), std::sin(a), 0}, up{0, 0, 1};
      const Vec3 n = std::cos(b) * out + std::sin(b) * up;
      return {out + tube * n, n, 1 / tube, std::abs(std::cos(b)) / to_axis, -std::sin(b) * out + std::cos(b) * up};
    }
  }
  AnalyticPoint plane() { return {{uniform(-1, 1), uniform(-1, 1), 0}, {0, 0, 1}, 0, 0, {}}; }

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  double gaussian(double sigma) { return sigma > 0 ? std::normal_distribution<double>(0, sigma)(random_) : 0; }

  template <class Draw>
  static std::vector<AnalyticPoint> draw(std::size_t n, Draw draw) {
    std::vector<AnalyticPoint> points;
    for (std::size_t i = 0; i < n; ++i) points.push_back(draw());
    return points;
  }

 private:
  std::mt19937_64 random_;
};

inline std::vector<Vec3> positions_of(std::span<const AnalyticPoint> points) {
  std::vector<Vec3> positions;
  for (const AnalyticPoint& p : points) positions.push_back(p.position);
  return positions;
}

using Column = std::vector<std::byte>;

template <class T>
Column column_of(const std::vector<T>& values) {
  Column bytes(values.size() * sizeof(T));
  if (!bytes.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

inline std::array<float, 3> narrow(Vec3 v) { return {float(v.x), float(v.y), float(v.z)}; }
inline Vec3 wide(std::array<float, 3> v) { return {v[0], v[1], v[2]}; }

inline Column normals_of(std::span<const AnalyticPoint> points) {
  std::vector<std::array<float, 3>> normals;
  for (const AnalyticPoint& p : points) normals.push_back(narrow(p.normal));
  return column_of(normals);
}

/// Returns the angle between the lines of two vectors, in radians.
inline double line_angle(Vec3 a, Vec3 b) { return std::atan2(length(cross(a, b)), std::abs(dot(a, b))); }

}  // namespace pointsweep
