// SPDX-License-Identifier: MIT
/// Points in memory as the source of a stream.
#pragma once

#include <algorithm>
#include <cstring>
#include <span>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/order/source.h"

namespace pointsweep {

/// Returns a source with the fields x, y, z in float64. `points` must outlive the source.
inline PointSource source_of(const std::vector<Vec3>& points) {
  Schema schema;
  for (const char* name : {"x", "y", "z"}) schema.append(name, Type::f64);
  return {schema, points.size(), [&points](std::uint64_t row, std::span<std::byte> records) {
            const std::size_t n = std::min<std::size_t>(records.size() / sizeof(Vec3), points.size() - row);
            std::memcpy(records.data(), &points[row], n * sizeof(Vec3));
            return n;
          }};
}

}  // namespace pointsweep
