// SPDX-License-Identifier: MIT
/// The distance between neighbouring points of a cloud at every place, estimated from a sample of the cloud.
#pragma once

#include <cstdint>
#include <vector>

#include "pointsweep/geometry.h"

namespace pointsweep {

/// Halves the sample along its longest side until 16 points are left; of these the two longer sides of their box say
/// how much surface belongs to each, and their distances to each other whether they lie in rows or clumps with nothing
/// between. So dense and sparse parts of a scan get their own spacing. Memory and time to
/// build follow the sample, a look-up is one comparison for each halving.
class SpacingTree {
 public:
  /// `sample` stands for `points` points of a surface. No finite point: every spacing is 0.
  SpacingTree(std::vector<Vec3> sample, std::uint64_t points);

  /// Side of the square that one point of the cloud has to itself around `p`, at most twice the distance to the nearest
  /// other point that is usual there.
  double spacing(Vec3 p) const;

 private:
  struct Node {
    int axis = -1;  ///< -1: a leaf
    double split = 0;
    std::uint32_t above = 0;  ///< node of what is not below the split; what is below follows its parent
    double spacing = 0;
  };
  void build(std::size_t begin, std::size_t end, double share);

  std::vector<Vec3> sample_;
  std::vector<Node> nodes_;
};

}  // namespace pointsweep
