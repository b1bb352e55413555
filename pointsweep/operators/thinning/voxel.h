// SPDX-License-Identifier: MIT
/// Keeping one point in each cube of a grid.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/in_order_operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/thinning/voxel_centroid.h"

namespace pointsweep {

/// Keeps one of the points of each voxel. Along each axis, voxel v holds the coordinates whose quotient by the size,
/// rounded to float64, lies in [v, v + 1): the grid depends on coordinates only, not on the cloud, and a point on a
/// face belongs to the voxel above it. Points without a finite place are all kept. The points are put in order by
/// voxel, so that memory holds the choice of one voxel at a time, for any size of voxels. With VoxelKeep::centroid the
/// kept point moves to the mean position, and attributes become means.
class Voxel final : public InOrderOperator {
 public:
  /// Throws UsageError for options out of their ranges.
  explicit Voxel(const VoxelOptions& options);
  std::string name() const override { return "voxel"; }
  InOrderContract in_order_contract() const override;
  std::shared_ptr<const InOrderOperator> bound(const Schema& input, std::span<const Attribute> made) const override;
  std::unique_ptr<InOrderWork> start(const InOrderSetup&) const override;
  /// Returns the numbers of the voxel along the axes.
  Vec3 place_of(Vec3 position) const override;
  std::optional<Reach> reach() const override { return Reach{}; }
  std::uint64_t least_bytes(const CloudEstimate&) const override;

 private:
  VoxelOptions options_;
  std::vector<AveragedAttribute> averaged_;
};

/// Returns the numbers of the voxel of a position along the axes.
Vec3 voxel_of_position(Vec3 position, double size);

/// Seed of the hashes that VoxelKeep::hash compares.
inline constexpr std::uint64_t kVoxelSeed = 0x766f78656c;

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
