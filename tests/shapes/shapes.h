// SPDX-License-Identifier: MIT
/// Points of a shape for the tests of this folder: in float64, with their normals.
#pragma once

#include <cstring>
#include <string_view>
#include <vector>

#include "pointsweep/program/generate.h"
#include "pointsweep/shapes/registry.h"

namespace pointsweep {

inline std::vector<std::byte> records_of(std::string_view shape, const Sampling& sampling) {
  const auto reader = generated_points(shape, sampling);
  std::vector<std::byte> records(reader->info().schema.stride * sampling.count);
  reader->read(0, records);
  return records;
}

inline std::vector<SurfacePoint> points_of(std::string_view shape, Sampling sampling) {
  sampling.float64 = true;
  const bool normals = create_shape(shape)->has_normals();
  const std::size_t stride = normals ? 36 : 24;
  const std::vector<std::byte> records = records_of(shape, sampling);
  std::vector<SurfacePoint> points(sampling.count);
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::memcpy(&points[i].position, records.data() + i * stride, 24);
    float n[3] = {0, 0, 0};
    if (normals) std::memcpy(n, records.data() + i * stride + 24, 12);
    points[i].normal = {n[0], n[1], n[2]};
  }
  return points;
}

inline std::vector<SurfacePoint> points_of(std::string_view shape, std::uint64_t count) {
  Sampling sampling;
  sampling.count = count;
  return points_of(shape, sampling);
}

}  // namespace pointsweep
