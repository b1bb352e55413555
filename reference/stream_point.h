// SPDX-License-Identifier: MIT
/// A point of the active set with all its fields (the paper's AllFields, Section 5.1 and Figure 10).
#pragma once

#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <memory>
#include <vector>

#include "reference/nearest_set.h"

namespace pointsweep::reference {

/// The index that stands for no point: larger than the index of every point.
inline constexpr std::uint64_t kNoIndex = std::numeric_limits<std::uint64_t>::max();

struct StreamPoint {
  StreamPoint(Vec3 p, std::uint64_t input_row, std::uint64_t stream_index, Reach reach)
      : input(p), position(p), row(input_row), index(stream_index), neighbors(reach) {}

  // InputFields and ReadOpFields
  Vec3 input;           ///< as in the input: search and order go by it
  Vec3 position;        ///< where an operator may have moved it
  std::uint64_t row;    ///< in the input
  std::uint64_t index;  ///< i, in the stream
  std::chrono::steady_clock::time_point read_at;

  // NeighborOpFields
  NearestSet neighbors;
  std::uint64_t min_index = kNoIndex;  ///< smallest index among the point and the neighbours it refers to
  std::uint64_t max_index = 0;         ///< largest; known once the neighbourhood is complete

  // Points that the search could not see when the point came (Audit)
  static constexpr double kNothing = std::numeric_limits<double>::infinity();
  std::vector<Rank> hidden;    ///< the nearest of the active points that had left S, nearest first
  std::uint64_t written = 0;   ///< so many points of the stream had been written
  double written2 = kNothing;  ///< squared distance along the axis to the last of them

  // Every other field, at the places that Fields gives them: the record of the file, attributes, an operator's copies
  std::unique_ptr<std::byte[]> fields;

  Neighbor as_neighbor_of(Vec3 p) { return {distance2(input, p), this}; }
};

/// The active set A: all points read and not yet written, a FIFO queue in stream order (Section 3).
using ActiveSet = std::deque<StreamPoint>;

}  // namespace pointsweep::reference
