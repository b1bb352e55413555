// SPDX-License-Identifier: MIT
/// Neighbourhoods that may lack a point, and what settles it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pointsweep/order/stream.h"
#include "reference/shortening.h"
#include "reference/sorted_slab.h"

namespace pointsweep::reference {

/// The nearest of the points offered, nearest first.
class NearestRanks {
 public:
  /// `nearest_first`: points offered before; of these the first k count.
  NearestRanks(Reach reach, std::vector<Rank> nearest_first);
  /// Squared distance within which a point may enter.
  double reach2() const { return ranks_.size() == reach_.k ? ranks_.back().distance2 : reach_.radius2; }
  void offer(const Rank& rank);
  std::span<const Rank> ranks() const { return ranks_; }

 private:
  Reach reach_;
  std::vector<Rank> ranks_;
};

struct Suspect {
  RuledPoint point;
  std::vector<Rank> kept;  ///< N_i as the stages see it
  NearestRanks exact;      ///< what the search should have found, but for the first points of the stream,
  std::uint64_t written;   ///< so many, which had been written when the point came
};

/// Suspects that wait for the points that had been written. These are read again from the stream, many suspects at a
/// time.
class Suspects {
 public:
  explicit Suspects(const Stream& stream) : stream_(stream) {}

  void add(Suspect suspect);
  /// Returns whether so many suspects wait that they should be settled.
  bool full() const { return bytes_ > kMostBytes; }
  std::uint64_t bytes() const { return bytes_; }
  /// Completes what the search should have found, and returns and forgets the suspects.
  std::vector<Suspect> settled();

 private:
  static constexpr std::uint64_t kMostBytes = 1 << 20;
  void offer_slab(std::size_t slab, std::span<Suspect*> near);

  const Stream& stream_;
  std::vector<Suspect> waiting_;
  std::uint64_t bytes_ = 0;
  SortedSlab slab_;
};

}  // namespace pointsweep::reference
