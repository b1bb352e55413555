// SPDX-License-Identifier: MIT
/// The comparison that decides which point of a voxel is kept.
#pragma once

#include <cstdint>
#include <tuple>

#include "pointsweep/geometry.h"

namespace pointsweep {

/// A point that a voxel may keep. The least candidate of a voxel is kept.
struct VoxelCandidate {
  double distance2 = 0;  ///< squared distance to the centre; 0 if the hash decides
  std::uint64_t hash = 0;
  Vec3 position;
  std::uint64_t row = 0;

  bool operator<(const VoxelCandidate& other) const { return key() < other.key(); }

 private:
  std::tuple<double, std::uint64_t, double, double, double, std::uint64_t> key() const {
    return {distance2, hash, position.x, position.y, position.z, row};
  }
};

/// Returns a candidate that is ranked by its distance to the centre of its voxel.
inline VoxelCandidate nearest_to_center(Vec3 voxel, double size, Vec3 p, std::uint64_t row) {
  const Vec3 center{(voxel.x + 0.5) * size, (voxel.y + 0.5) * size, (voxel.z + 0.5) * size};
  return {distance2(p, center), 0, p, row};
}

}  // namespace pointsweep
