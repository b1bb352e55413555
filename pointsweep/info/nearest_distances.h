// SPDX-License-Identifier: MIT
/// Exact distances from some points of a cloud to their nearest neighbours, in one pass over the cloud.
#pragma once

#include <cstdint>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/math/box.h"

namespace pointsweep {

/// A kd-tree over the points whose distances are sought, the sample. Every node stores the largest nearest distance of
/// the sampled points below it. A point of the cloud visits only the nodes with a sampled point that may be closer than
/// this distance. Memory is proportional to the size of the sample.
class NearestDistances {
 public:
  struct Sampled {
    Vec3 position;  ///< finite
    std::uint64_t row;
  };
  explicit NearestDistances(std::vector<Sampled> sample);

  /// Takes a finite point of the cloud. A sampled point is not its own neighbour; other points at distance 0 are.
  void add(Vec3 position, std::uint64_t row);

  /// Returns the distances of all sampled points with a neighbour, ascending.
  std::vector<double> distances() const;

 private:
  struct Node {
    Box box;
    double farthest2;                 ///< largest squared nearest distance of the sampled points below
    std::uint32_t begin, end, above;  ///< points of the sample; `above`: second child, 0 in a leaf
  };
  void build(std::uint32_t begin, std::uint32_t end);
  void visit(std::uint32_t node, Vec3 position, std::uint64_t row);

  std::vector<Sampled> sample_;
  std::vector<double> nearest2_;
  std::vector<Node> nodes_;
};

}  // namespace pointsweep
