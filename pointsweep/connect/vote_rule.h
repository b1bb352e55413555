// SPDX-License-Identifier: MIT
/// A rule that decides about each component of a graph by votes: sums over the points of the component. Some sums
/// depend on the signs of the points (ForestEdge).
#pragma once

#include <cstddef>

#include "pointsweep/connect/forest_edge.h"

namespace pointsweep {

/// Makes, merges and concludes votes. Votes are bytes that can be copied; they depend on the set of points and on their
/// signs, not on the order of merges. A ballot holds the values of a point from which start() makes its votes.
class VoteRule {
 public:
  virtual ~VoteRule() = default;
  virtual std::size_t ballot_bytes() const = 0;
  virtual std::size_t bytes() const = 0;
  /// Sets `votes` to the votes of one point.
  virtual void start(std::byte* votes, const PointKey& point, const std::byte* ballot) const = 0;
  /// Adds the votes `from` to `into`. If `flips`, the points of `from` count with opposite signs.
  virtual void merge(std::byte* into, const std::byte* from, bool flips) const = 0;
  /// Returns the size in bytes of a result, which replaces the votes of a whole component.
  virtual std::size_t result_bytes() const = 0;
  virtual void conclude(const std::byte* votes, std::byte* result) const = 0;
  /// Returns whether the component gets a number.
  virtual bool counts(const std::byte* result) const {
    (void)result;
    return true;
  }
  /// Returns whether all signs of the component must be turned.
  virtual bool turns(const std::byte* result) const {
    (void)result;
    return false;
  }
};

}  // namespace pointsweep
