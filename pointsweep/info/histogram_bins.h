// SPDX-License-Identifier: MIT
/// Bins of a histogram between round numbers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pointsweep/info/value_keys.h"
#include "pointsweep/math/exact_sum.h"

namespace pointsweep {

/// Bins of equal width over a range of values. A bin includes its lower edge and excludes its upper edge. Edges are
/// multiples of the width: the least of 1, 2 and 5 times a power of ten that gives at most the requested number of
/// bins, and at least 1 for whole numbers.
class HistogramBins {
 public:
  /// `least` and `most`: keys. `wanted`: 2 or more, since 0 is an edge.
  HistogramBins(const ValueKeys& keys, std::uint64_t least, std::uint64_t most, std::uint64_t wanted);

  std::size_t size() const { return static_cast<std::size_t>(last_ - first_) + 1; }
  /// Returns size() + 1 edges, ascending. A multiple beyond float64 becomes its greatest number.
  std::vector<double> edges() const;
  /// Returns the bin, below size(), of a value.
  std::size_t bin_of(const ValueKeys& keys, std::uint64_t key) const;

 private:
  void set_width(int digit, int exponent);
  /// Returns the greatest multiple of the width that is not above the value.
  std::int64_t multiple_below(const ValueKeys& keys, std::uint64_t key) const;
  double edge(std::int64_t multiple) const;

  int digit_ = 1, exponent_ = 0;       ///< the width is digit_ * 10^exponent_
  double power_ = 1;                   ///< 10^|exponent_|
  Int128 whole_width_ = 1;             ///< width for whole numbers
  std::int64_t first_ = 0, last_ = 0;  ///< lower edges of the first and the last bin, as multiples of the width
};

}  // namespace pointsweep
