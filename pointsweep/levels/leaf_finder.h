// SPDX-License-Identifier: MIT
/// The leaves of the octree, found in one pass along the Morton curve.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pointsweep/levels/curve_key.h"

namespace pointsweep {

/// An octant with more points than this is divided, unless all its points lie at one place.
inline constexpr std::uint64_t kMostLeafPoints = 100'000;

/// An octant that is not divided, and the numbers of its points on the curve.
struct Leaf {
  CurveKey key;  ///< first key of the octant
  int depth;
  std::uint64_t first, count;
  std::uint64_t end() const { return first + count; }
};

/// Returns the leaf that contains the octant; null if the octant is divided or has no points. `leaves`: all leaves in
/// order.
const Leaf* leaf_around(std::span<const Leaf> leaves, const Octant& octant);

class LeafFinder {
 public:
  LeafFinder() { first_.fill(0); }
  /// Takes the keys of the next points. Keys ascend.
  void add(std::span<const CurveKey> keys);
  /// Returns the leaves in the order of the curve; empty if there are no points.
  std::vector<Leaf> finish();

 private:
  void close(int depth);

  std::array<std::uint64_t, kMostDepth + 1> first_;  ///< for each depth, number of the first point in the octant of
                                                     ///< the last point
  CurveKey last_;
  std::uint64_t count_ = 0;
  std::uint64_t first_at_last_ = 0;  ///< number of the first point with the key of the last point
  std::vector<Leaf> leaves_;
};

}  // namespace pointsweep
