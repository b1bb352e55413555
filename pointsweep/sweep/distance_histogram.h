// SPDX-License-Identifier: MIT
/// How far neighbours are, counted while the neighbourhoods pass by.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace pointsweep {

/// Counts of distances in eight bins for each octave, whatever their size: the bin is what the first bits of the
/// squared distance as an IEEE double say. 64 KB; the same counts in any order.
class DistanceHistogram {
 public:
  static constexpr std::size_t kBins = 8192;

  void add(double distance2) { ++counts_[std::bit_cast<std::uint64_t>(distance2) >> 50 & (kBins - 1)]; }
  void add(const DistanceHistogram& other) {
    for (std::size_t i = 0; i < kBins; ++i) counts_[i] += other.counts_[i];
  }
  std::uint64_t count(std::size_t bin) const { return counts_[bin]; }
  /// Smallest squared distance of the bin. Bin 0 is 0 and what is too small to tell from it.
  static double lower_end2(std::size_t bin) { return std::bit_cast<double>(std::uint64_t{bin} << 50); }

 private:
  std::array<std::uint64_t, kBins> counts_{};
};

/// Of each point the distances to the nearest and to the farthest of its neighbourhood.
struct NeighborDistances {
  DistanceHistogram nearest, farthest;
  void add(const NeighborDistances& other) {
    nearest.add(other.nearest);
    farthest.add(other.farthest);
  }
};

}  // namespace pointsweep
