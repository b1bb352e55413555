// SPDX-License-Identifier: MIT
/// Histograms of the distances to neighbours, filled during the sweep.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace pointsweep {

/// Counts of distances in eight bins per octave. The number of a bin is the leading bits of the squared distance as an
/// IEEE double. Counts do not depend on the order of distances. Memory: 64 KB.
class DistanceHistogram {
 public:
  static constexpr std::size_t kBins = 8192;

  void add(double distance2) { ++counts_[std::bit_cast<std::uint64_t>(distance2) >> 50 & (kBins - 1)]; }
  void add(const DistanceHistogram& other) {
    for (std::size_t i = 0; i < kBins; ++i) counts_[i] += other.counts_[i];
  }
  std::uint64_t count(std::size_t bin) const { return counts_[bin]; }
  /// Returns the smallest squared distance of a bin. Bin 0 holds 0 and the smallest squared distances.
  static double lower_end2(std::size_t bin) { return std::bit_cast<double>(std::uint64_t{bin} << 50); }

 private:
  std::array<std::uint64_t, kBins> counts_{};
};

/// Histograms of the distances from each point to the nearest and to the farthest point of its neighbourhood.
struct NeighborDistances {
  DistanceHistogram nearest, farthest;
  void add(const NeighborDistances& other) {
    nearest.add(other.nearest);
    farthest.add(other.farthest);
  }
};

}  // namespace pointsweep
