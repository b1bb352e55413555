// SPDX-License-Identifier: MIT
#include "pointsweep/info/histogram_bins.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pointsweep {
namespace {

/// Multiples up to this number are exact, and no two edges are equal.
constexpr double kMostMultiple = 0x1p50;

/// Returns a / b rounded down; b > 0.
Int128 floor_of_quotient(Int128 a, Int128 b) { return a / b - (a % b < 0 ? 1 : 0); }

}  // namespace

HistogramBins::HistogramBins(const ValueKeys& keys, std::uint64_t least, std::uint64_t most, std::uint64_t wanted) {
  const double lo = keys.real(least), hi = keys.real(most), bins = static_cast<double>(wanted);
  const double greatest = std::max(std::abs(lo), std::abs(hi));
  const double least_width = std::max(hi / bins - lo / bins, greatest / kMostMultiple);
  int exponent = least == most || least_width == 0 ? 0 : static_cast<int>(std::floor(std::log10(least_width)));
  if (keys.is_whole()) exponent = std::max(exponent, 0);
  for (;; ++exponent) {
    for (const int digit : {1, 2, 5}) {
      set_width(digit, exponent);
      if (!(greatest / edge(1) <= kMostMultiple)) continue;
      first_ = multiple_below(keys, least);
      last_ = multiple_below(keys, most);
      if (static_cast<std::uint64_t>(last_ - first_) < wanted) return;
    }
  }
}

void HistogramBins::set_width(int digit, int exponent) {
  digit_ = digit;
  exponent_ = exponent;
  power_ = std::pow(10.0, std::abs(exponent));
  whole_width_ = digit;
  for (int i = 0; i < std::min(exponent, 19); ++i) whole_width_ *= 10;
}

/// Returns the float64 nearest to the decimal number for exponents of -22 to 22; infinite beyond the range of float64.
double HistogramBins::edge(std::int64_t multiple) const {
  const double units = static_cast<double>(multiple) * digit_;
  return exponent_ < 0 ? units / power_ : units * power_;
}

std::int64_t HistogramBins::multiple_below(const ValueKeys& keys, std::uint64_t key) const {
  if (keys.is_whole()) return static_cast<std::int64_t>(floor_of_quotient(keys.whole(key), whole_width_));
  const double value = keys.real(key);
  auto multiple = static_cast<std::int64_t>(std::floor(value / edge(1)));
  while (value < edge(multiple)) --multiple;
  while (value >= edge(multiple + 1)) ++multiple;
  return multiple;
}

std::vector<double> HistogramBins::edges() const {
  constexpr double kMost = std::numeric_limits<double>::max();
  std::vector<double> edges;
  for (std::size_t bin = 0; bin <= size(); ++bin)
    edges.push_back(std::clamp(edge(first_ + static_cast<std::int64_t>(bin)), -kMost, kMost));
  return edges;
}

std::size_t HistogramBins::bin_of(const ValueKeys& keys, std::uint64_t key) const {
  return static_cast<std::size_t>(std::clamp(multiple_below(keys, key), first_, last_) - first_);
}

}  // namespace pointsweep
