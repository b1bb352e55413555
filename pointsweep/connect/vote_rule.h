// SPDX-License-Identifier: MIT
/// Votes decide about a component. They are sums over its points, some of which change with the sign of a point.
#pragma once

#include <cstddef>

#include "pointsweep/connect/forest_edge.h"

namespace pointsweep {

/// Votes are bytes that can be copied. They depend on the set of points and on their signs, not on the order in which
/// they are merged. A ballot holds the values of one point, besides its key, from which its votes are made.
class VoteRule {
 public:
  virtual ~VoteRule() = default;
  virtual std::size_t ballot_bytes() const = 0;
  virtual std::size_t bytes() const = 0;
  /// Sets the votes of one point.
  virtual void start(std::byte* votes, const PointKey& point, const std::byte* ballot) const = 0;
  /// Adds the votes `from` to `into`, with opposite signs if `flips`.
  virtual void merge(std::byte* into, const std::byte* from, bool flips) const = 0;
  /// Returns the bytes of a result. Of the votes of a whole component, only the result is kept.
  virtual std::size_t result_bytes() const = 0;
  virtual void conclude(const std::byte* votes, std::byte* result) const = 0;
  /// Returns whether the component gets a number.
  virtual bool counts(const std::byte* result) const {
    (void)result;
    return true;
  }
  /// Returns whether the signs of the component are to be turned.
  virtual bool turns(const std::byte* result) const {
    (void)result;
    return false;
  }
};

}  // namespace pointsweep
