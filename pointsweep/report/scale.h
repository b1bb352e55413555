// SPDX-License-Identifier: MIT
/// The scale of a plot, from values to places, and the round values that are written beside it.
#pragma once

#include <string>
#include <vector>

namespace pointsweep {

struct Tick {
  double value;
  std::string text;
};

/// A linear or logarithmic axis over [lo, hi], drawn from `begin` to `end`.
class Scale {
 public:
  /// Logarithmic: lo and hi must be positive. An empty range is widened.
  Scale(double lo, double hi, double begin, double end, bool logarithmic = false);

  double place(double value) const;
  /// About `wanted` of them at 1, 2 or 5 times a power of ten; powers of ten (with 2 and 5 where these are few) if
  /// logarithmic.
  std::vector<Tick> ticks(int wanted) const;

 private:
  double lo_, hi_, begin_, end_;
  bool logarithmic_;
};

/// Formats a number briefly, in engineering's thousands where that is shorter: "0", "12", "1.5k", "20M", "3.2e-05".
std::string short_number(double value);

}  // namespace pointsweep
