// SPDX-License-Identifier: MIT
/// The statistics of all points in a LAS header: bounds and the number of points by return.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "pointsweep/formats/las/las_header.h"

namespace pointsweep {

class LasStatistics {
 public:
  explicit LasStatistics(int point_format);

  /// Takes `count` LAS records, `stride` bytes apart.
  void add(const std::byte* records, std::size_t stride, std::size_t count);
  /// Takes the points that `other` has taken.
  void add(const LasStatistics& other);
  /// Points taken so far.
  std::uint64_t count() const { return count_; }
  /// Sets counts and bounds; without points the bounds are 0.
  void put_into(LasHeader& header) const;

 private:
  static constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min();
  static constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();

  std::array<std::int32_t, 3> lo_{kMost, kMost, kMost}, hi_{kLeast, kLeast, kLeast};
  std::array<std::uint64_t, 16> by_return_{};
  std::uint64_t count_ = 0;
  std::uint8_t return_mask_;
};

}  // namespace pointsweep
