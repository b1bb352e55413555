// SPDX-License-Identifier: MIT
/// Point sources made of vectors, for the tests of the ordered stream.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <random>
#include <span>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/order/source.h"

namespace pointsweep {

/// A source of records of x, y, z of type T, and a tag that differs between records.
template <class T>
struct CloudSource {
  std::vector<std::byte> bytes;
  PointSource source;

  CloudSource(const CloudSource&) = delete;
  explicit CloudSource(const std::vector<Vec3>& points) {
    constexpr Type type = sizeof(T) == 4 ? Type::f32 : Type::f64;
    for (const char* name : {"x", "y", "z"}) source.schema.append(name, type);
    source.schema.append("tag", Type::u32);
    const std::size_t stride = source.schema.stride;
    bytes.resize(points.size() * stride);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const T xyz[3] = {static_cast<T>(points[i].x), static_cast<T>(points[i].y), static_cast<T>(points[i].z)};
      const auto tag = static_cast<std::uint32_t>(i * 2654435761u);
      std::memcpy(&bytes[i * stride], xyz, sizeof xyz);
      std::memcpy(&bytes[i * stride + sizeof xyz], &tag, sizeof tag);
    }
    source.count = points.size();
    source.read = [this, stride](std::uint64_t row, std::span<std::byte> out) {
      const std::size_t n = std::min<std::size_t>(out.size() / stride, source.count - row);
      std::memcpy(out.data(), bytes.data() + row * stride, n * stride);
      return n;
    };
  }
};

inline std::vector<Vec3> random_points(std::size_t n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Vec3> points(n);
  for (Vec3& p : points) p = {3 * uniform(random), 2 * uniform(random), uniform(random)};
  return points;
}

}  // namespace pointsweep
